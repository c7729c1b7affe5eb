// SPDX-License-Identifier: MIT
/** The screen Shapes: in motion, their complexity, and how alike they are. */

import { deskScreen } from "./desk_frame.js";
import { el, fill, say, typesInField } from "./dom.js";
import { shown } from "./numbers.js";
import { phaseScatter } from "./phase_scatter.js";
import { ShapeView } from "./shape_view.js";
import { onTheme } from "./theme.js";

deskScreen("Shapes", async (desk, place) => {
  let page = await desk.get("shapes");
  if (page.names.length < 2) {
    fill(place, el("p", { class: "panel" }, "One point was measured: there is no shape to draw."));
    return () => {};
  }
  const stage = el("div", { class: "plot" });
  const facts = el("p", { class: "note" });
  const scatter = /** @type {HTMLCanvasElement} */ (el("canvas", { role: "img", "aria-label": "Components of the mode in the complex plane" }));
  const modes = el("ul", { class: "mode-list", role: "list" });
  const mac = el("div", { class: "scroll" });
  const play = el("button", { type: "button", click: () => stop() });
  const size = el("input", {
    type: "range", min: 0.2, max: 3, step: 0.1, value: 1, "aria-label": "Size of the motion",
    input: (/** @type {any} */ event) => {
      view.size = Number(event.target.value);
      view.draw();
    },
  });
  const view = new ShapeView(stage, page);
  const stop = (toggle = true) => {
    if (toggle) view.toggle();
    fill(play, view.playing ? "Stop " : "Play ", el("kbd", {}, "Space"));
  };
  stop(false);
  let now = Number(new URLSearchParams(location.search).get("mode") ?? 1) - 1;
  const where = page.measured
    ? "On the geometry given; drag or arrow keys turn it."
    : "The points stand in a row in measured order; --geometry gives their positions.";
  const scattered = () => {
    const mode = page.modes[now];
    if (mode) phaseScatter(scatter, mode, page.labels);
  };
  onTheme(scattered);
  const choose = (/** @type {number} */ number) => {
    now = number;
    const mode = page.modes[now];
    if (!mode) return;
    const query = new URLSearchParams(location.search);
    query.set("mode", String(now + 1));
    history.replaceState(null, "", `?${query}`);
    [...modes.querySelectorAll("button")].forEach((one, i) => (
      one.setAttribute("aria-pressed", String(i === now))));
    view.show(mode);
    say(facts, `Mode ${now + 1}: ${shown(mode.frequency_hz, 7)} Hz, damping ${shown(100 * mode.damping_ratio)} %, `
      + `MPC ${shown(mode.mpc)}, mean phase deviation ${shown(mode.mpd_deg, 3)}°. ${where}`);
    scattered();
    scatter.setAttribute("aria-label", `Components of mode ${now + 1} in the complex plane, MPC ${shown(mode.mpc, 3)}`);
  };
  document.addEventListener("keydown", (event) => {
    if (typesInField(event) || event.target instanceof HTMLButtonElement) return;
    if (event.key === " ") {
      event.preventDefault();
      stop();
    } else if (event.key === "n" && page.modes.length) choose((now + 1) % page.modes.length);
  });
  fill(place, el("div", { class: "desk-grid shapes" },
    el("section", { class: "panel", "aria-label": "Shape" },
      el("div", { class: "row between" }, el("h2", {}, "Shape"),
        el("div", { class: "row" }, play, el("label", {}, "Size ", size))),
      modes, facts, stage),
    el("div", { class: "stack" },
      el("section", { class: "panel", "aria-label": "Complexity" }, el("h2", {}, "Complexity"),
        el("p", { class: "note" }, "A real mode lies on one line."), scatter),
      el("section", { class: "panel", "aria-label": "AutoMAC" }, el("h2", {}, "AutoMAC"),
        el("p", { class: "note" }, "1 on the diagonal; high values off it are modes that the points cannot distinguish."), mac))));
  return async () => {
    page = await desk.get("shapes");
    now = Math.max(0, Math.min(now, page.modes.length - 1));
    fill(modes, ...page.modes.map((/** @type {any} */ one, /** @type {number} */ i) => el("li", {},
      el("button", { type: "button", click: () => choose(i) }, `${i + 1}: ${shown(one.frequency_hz, 5)} Hz`))));
    fill(mac, page.modes.length ? macTable(page.mac) : el("p", { class: "note" }, "No mode is chosen."));
    choose(now);
  };
});

/** @param {number[][]} mac */
function macTable(mac) {
  const step = (/** @type {number} */ value) => `mac-${Math.min(5, Math.floor(value * 5 + 1e-9))}`;
  return el("table", { class: "mac" },
    el("caption", { class: "unseen" }, "Modal assurance criterion"),
    el("thead", {}, el("tr", {}, el("th", {}, ""), ...mac.map((_, i) => el("th", { scope: "col" }, i + 1)))),
    el("tbody", {}, ...mac.map((row, i) => el("tr", {}, el("th", { scope: "row" }, i + 1),
      ...row.map((value) => el("td", { class: step(value) }, value.toFixed(2)))))));
}
