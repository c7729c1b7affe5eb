// SPDX-License-Identifier: MIT
/** One FRF: size in decibels and phase, measured and synthesised, and coherence. */

import { curvePlot } from "./curves.js";
import { el, fill } from "./dom.js";
import { json } from "./link.js";

const CURVES = [
  { name: "measured", colour: "curve-1" },
  { name: "synthesised", colour: "curve-2", dashed: true, width: 2 },
];

/** @param {(number | null)[]} values */
const decibel = (values) => values.map((v) => (v === null || v <= 0 ? null : 20 * Math.log10(v)));

/**
 * Make the plots in an element.
 * @param {HTMLElement} parent
 * @param {{number: number, unit: string, small?: boolean}} given
 */
export function frfPlots(parent, given) {
  const size = el("div", { class: "plot" });
  const phase = el("div", { class: "plot" });
  const coherence = el("div", { class: "plot" });
  const key = el("p", { class: "note keys" },
    el("span", { class: "line-key measured" }), "measured  ",
    el("span", { class: "line-key fitted" }), "synthesised from the modes");
  fill(parent, key, size, ...(given.small ? [] : [phase, coherence]));
  const x = "frequency [Hz]";
  const sizes = curvePlot(size, {
    x: given.small ? x : "", y: `|H| [dB re 1 ${given.unit}]`, curves: CURVES,
    height: given.small ? 250 : 280, label: "Size of the FRF, measured and synthesised",
  });
  const phases = given.small ? null : curvePlot(phase, {
    x: "", y: "phase [deg]", curves: CURVES, height: 215, yRange: [-190, 190],
    label: "Phase of the FRF, measured and synthesised",
  });
  const coherences = given.small ? null : curvePlot(coherence, {
    x, y: "coherence [-]", curves: [{ name: "coherence", colour: "curve-3" }], height: 170,
    yRange: [0, 1.05], label: "Ordinary coherence",
  });
  let asked = 0;
  return {
    /**
     * @param {number} output
     * @param {number} input
     */
    async show(output, input) {
      asked += 1;
      const own = asked;
      const page = await json(`/desk/${given.number}/frf/${output}/${input}`);
      if (own !== asked) return null;
      sizes.show([page.frequency_hz, decibel(page.size), decibel(page.fitted)]);
      phases?.show([page.frequency_hz, page.phase_deg, page.fitted_phase_deg]);
      coherence.hidden = !page.coherence;
      if (page.coherence) coherences?.show([page.frequency_hz, page.coherence]);
      return page;
    },
  };
}

/**
 * Make selections of an output and an input.
 * @param {{outputs: string[], inputs: string[]}} of
 * @param {(output: number, input: number) => void} chosen
 */
export function pairChoice(of, chosen) {
  const ask = (/** @type {string} */ name, /** @type {string[]} */ labels) => el("select", {
    "aria-label": name,
    change: () => chosen(Number(output.value), Number(input.value)),
  }, ...labels.map((one, i) => el("option", { value: i }, one || `${name} ${i + 1}`)));
  const output = /** @type {HTMLSelectElement} */ (ask("Response", of.outputs));
  const input = /** @type {HTMLSelectElement} */ (ask("Force at", of.inputs));
  return {
    row: el("div", { class: "row" },
      el("label", {}, "Response ", output), el("label", {}, "Force at ", input)),
    /**
     * @param {number} o
     * @param {number} i
     */
    set(o, i) {
      output.value = String(o);
      input.value = String(i);
    },
    now: () => /** @type {[number, number]} */ ([Number(output.value), Number(input.value)]),
  };
}
