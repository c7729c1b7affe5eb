// SPDX-License-Identifier: MIT
/** The table of chosen modes, with what can be done to each. */

import { el, fill } from "./dom.js";
import { shown } from "./numbers.js";
import { uncertain } from "./uncertain.js";

const HEADS = ["words", "", "", "wide-only", "wide-only", ""];

/**
 * @param {import("./desk_frame.js").Desk} desk
 * @param {() => import("./pole_chart.js").PoleChart} chart
 */
export function modeTable(desk, chart) {
  /** @type {Set<number>} frequencies of the modes that are ticked */
  const ticked = new Set();
  const merge = el("button", {
    type: "button", disabled: true,
    click: async () => {
      const [one, other] = [...ticked];
      if (await desk.choose({ action: "merge", frequency: one, second: other })) ticked.clear();
    },
  }, "Merge two");
  const mark = () => merge.toggleAttribute("disabled", ticked.size !== 2);
  const clear = (/** @type {number} */ hertz) => desk.choose({
    action: "clear", frequency: hertz * (1 - 1e-6), second: hertz * (1 + 1e-6),
  });

  /** @param {import("./desk_frame.js").Mode[]} modes */
  const show = (modes) => {
    ticked.clear();
    mark();
    if (!modes.length) return el("p", { class: "note" }, "No pole is chosen. Click one in the diagram.");
    return el("table", { class: "modes" },
      el("caption", {}, "± one standard deviation. Tick two to merge them."),
      el("thead", {}, el("tr", {}, ...["", "f [Hz]", "damping [%]", "MPC", "by", ""].map((one, i) => (
        el("th", { class: HEADS[i] }, one))))),
      el("tbody", {}, ...modes.map((one, i) => row(one, i))));
  };
  /**
   * @param {import("./desk_frame.js").Mode} one
   * @param {number} i
   */
  const row = (one, i) => {
    const name = `mode ${i + 1}`;
    const tick = el("input", {
      type: "checkbox", "aria-label": `Tick ${name}`,
      change: (/** @type {any} */ event) => {
        if (event.target.checked) ticked.add(one.frequency_hz);
        else ticked.delete(one.frequency_hz);
        mark();
      },
    });
    return el("tr", {},
      el("td", { class: "words" }, el("label", { class: "tick" }, tick, ` ${i + 1}`)),
      stacked(one.frequency_hz, one.frequency_sd_hz),
      stacked(100 * one.damping_ratio, 100 * one.damping_ratio_sd),
      el("td", { class: "wide-only" }, shown(one.mpc, 3)),
      el("td", { class: "wide-only" }, one.pinned ? "pinned" : one.by_hand ? "hand" : "program"),
      el("td", { class: "acts" },
        el("button", {
          type: "button", class: "small", "aria-label": `Show ${name} in the diagram`, title: "Show in the diagram",
          click: () => near(one),
        }, "◎"),
        el("button", {
          type: "button", class: "small", "aria-label": `Clear ${name}`, title: "Clear",
          click: () => clear(one.frequency_hz),
        }, "✕")));
  };
  /** @param {import("./desk_frame.js").Mode} one */
  const near = (one) => {
    const half = Math.max(10 * one.damping_ratio * one.frequency_hz, 0.01 * one.frequency_hz);
    chart().show(one.frequency_hz - half, one.frequency_hz + half);
    if (one.row >= 0) chart().look(one.row);
  };
  return { actions: el("div", { class: "row" }, merge), show };
}

/**
 * Return a cell with a value and, below it, its standard deviation, both to two digits
 * of the latter.
 * @param {number} value
 * @param {number} sd
 */
function stacked(value, sd) {
  const { value: number, sd: spread, power } = uncertain(value, sd);
  return el("td", {}, number + power, spread ? el("br") : null,
    spread ? el("span", { class: "sd" }, `± ${spread}${power}`) : null);
}
