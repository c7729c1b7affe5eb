// SPDX-License-Identifier: MIT
/** Natural frequency and damping over amplitude, beside the poles. */

import { curvePlot } from "./curves.js";
import { el, fill } from "./dom.js";
import { shown } from "./numbers.js";

/** @param {import("./desk_frame.js").Desk} desk */
export function amplitudePanel(desk) {
  const words = el("p", { class: "note" });
  const frequency = el("div", { class: "plot" });
  const damping = el("div", { class: "plot" });
  const pick = /** @type {HTMLSelectElement} */ (el("select", {
    "aria-label": "Mode", change: () => draw(),
  }));
  const compute = el("button", {
    type: "button",
    click: async () => {
      if (await desk.order("resolve", "Resolving the modes over their amplitude…")) {
        desk.summary = { ...desk.summary, curves: true };
        await show();
      }
    },
  }, "Resolve over amplitude");
  const section = el("section", { class: "panel", "aria-label": "Over amplitude" },
    el("h2", {}, "Over amplitude"), el("div", { class: "row" }, pick, compute), words, frequency, damping);
  const lines = [
    { name: "value", colour: "curve-1", width: 2 },
    { name: "lower", colour: "curve-old", width: 1 },
    { name: "upper", colour: "curve-old", width: 1 },
  ];
  /** @type {any} */
  let plots = null;
  /** @type {any[]} */
  let modes = [];
  const draw = () => {
    const mode = modes[Number(pick.value)];
    if (!mode) return;
    fill(words, `${mode.dependence}: ${mode.reason}`);
    frequency.hidden = damping.hidden = !mode.amplitude;
    if (!mode.amplitude) return;
    const name = `amplitude [${mode.unit}] at ${mode.channel}`;
    fill(frequency);
    fill(damping);
    const made = (/** @type {HTMLElement} */ at, /** @type {string} */ y) => curvePlot(at, {
      x: name, y, curves: lines, height: 170, xLog: true, label: `${y} over amplitude, with one sd`,
    });
    plots = [made(frequency, "f [Hz]"), made(damping, "damping [%]")];
    const around = (/** @type {number[]} */ values, /** @type {number[]} */ sd, /** @type {number} */ unit) => [
      mode.amplitude, values.map((v) => unit * v),
      values.map((v, i) => unit * (v - sd[i])), values.map((v, i) => unit * (v + sd[i])),
    ];
    plots[0].show(around(mode.curve_hz, mode.curve_hz_sd, 1));
    plots[1].show(around(mode.damping_ratio, mode.damping_ratio_sd, 100));
  };
  const show = async () => {
    const { hits_known: hits, curves } = desk.summary;
    compute.hidden = !hits || curves;
    pick.hidden = !curves;
    frequency.hidden = damping.hidden = true;
    if (!hits) fill(words, "FRFs from files have no hits at different levels.");
    else if (!curves) fill(words, "Not computed for the modes as they are chosen now.");
    if (!hits || !curves) return;
    modes = await desk.get("curves");
    fill(pick, ...modes.map((one, i) => el("option", { value: i }, `mode at ${shown(one.frequency_hz, 6)} Hz`)));
    draw();
  };
  return { section, show };
}
