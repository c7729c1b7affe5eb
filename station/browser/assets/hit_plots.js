// SPDX-License-Identifier: MIT
/** Pulse, force spectrum and response of the hits of a point; FRF and coherence. */

import { el } from "./dom.js";
import { shown } from "./numbers.js";

const OVERLAID = 8;

/** @typedef {import("./curves.js").Curve} Curve */

export class HitPlots {
  constructor() {
    /** @type {any[]} of the present condition, the latest last */
    this.pictures = [];
    this.condition = "";
    /** @type {Record<string, string>} */
    this.units = {};
    this.pulseBox = box("Force pulse");
    this.spectrumBox = box("Force spectrum re its maximum");
    this.responseBox = box("Response");
    this.frfBox = box("FRF");
    this.phaseBox = box("Phase");
    this.coherenceBox = box("Coherence");
    /** @type {Record<string, import("./curves.js").CurvePlot>} */
    this.plots = {};
  }

  /** @param {typeof import("./curves.js").curvePlot} make */
  build(make) {
    const one = (/** @type {string} */ name) => [{ name, colour: "curve-1", width: 2 }];
    this.plots = {
      pulse: make(plotOf(this.pulseBox), { x: "time after the trigger [ms]", y: "force [N]", curves: one("force"), label: "Force pulses of the hits at this point over time" }),
      spectrum: make(plotOf(this.spectrumBox), { x: "frequency [Hz]", y: "force [dB]", yRange: [-60, 3], curves: one("force"), label: "Force spectra of the hits at this point" }),
      response: make(plotOf(this.responseBox), { x: "time after the trigger [ms]", y: "response", curves: one("response"), label: "Responses to the hits at this point over time" }),
      frf: make(plotOf(this.frfBox), { x: "frequency [Hz]", y: "FRF [dB]", curves: one("FRF"), label: "Magnitude of the averaged FRF" }),
      phase: make(plotOf(this.phaseBox), { x: "frequency [Hz]", y: "phase [deg]", yRange: [-185, 185], curves: one("phase"), label: "Phase of the averaged FRF" }),
      coherence: make(plotOf(this.coherenceBox), { x: "frequency [Hz]", y: "coherence [-]", yRange: [0, 1.02], curves: one("coherence"), label: "Coherence of the averaged FRF" }),
    };
  }

  /**
   * Show the average of one response.
   * @param {any} state
   * @param {string} name of the response
   */
  average(state, name) {
    const average = state.average;
    const curve = average?.frf?.[name] ?? [];
    const coherence = average?.coherence?.[name] ?? [];
    const unit = state.channels.find((/** @type {any} */ one) => one.name === name)?.si;
    title(this.frfBox, name ? `FRF of ${name}${unit ? `, re 1 (${unit})/N` : ""}${curve.length && average?.good ? `, average of ${average.good} hit${average.good > 1 ? "s" : ""}` : ""}` : "FRF");
    const mean = average?.mean_coherence;
    title(this.coherenceBox, name ? `Coherence of ${name}${mean == null ? "" : `, mean over band and channels ${shown(mean, 3)}`}` : "Coherence");
    const [low, high] = average?.band?.length ? average.band : [0, 1];
    this.plots.frf.show([steps(low, high, curve.length), curve]);
    const phase = average?.phase?.[name] ?? [];
    title(this.phaseBox, name ? `Phase of ${name}` : "Phase");
    this.plots.phase.show([steps(low, high, phase.length), phase]);
    empty(this.phaseBox, phase.length === 0, "after the first good hit");
    this.plots.coherence.show([steps(low, high, coherence.length), coherence]);
    empty(this.frfBox, curve.length === 0, "after the first good hit");
    empty(this.coherenceBox, coherence.length === 0, "from two good hits on");
  }

  /**
   * Add a hit; those of another condition leave.
   * @param {any} picture
   * @param {any} state
   * @param {string} name of the response
   */
  add(picture, state, name) {
    const hit = state.hits.find((/** @type {any} */ one) => one.number === picture.hit);
    const condition = hit?.condition ?? "";
    if (condition !== this.condition) this.pictures = [];
    this.condition = condition;
    this.units = Object.fromEntries(state.channels.map((/** @type {any} */ c) => [c.name, c.si]));
    this.pictures = this.pictures.filter((one) => one.hit !== picture.hit);
    this.pictures.push({ ...picture, good: hit?.verdict === "ok" || hit?.word === "trial" });
    this.pictures = this.pictures.slice(-OVERLAID);
    this.redraw(name);
  }

  /** @param {string} name of the response */
  redraw(name) {
    const list = this.pictures;
    for (const part of [this.pulseBox, this.spectrumBox, this.responseBox]) empty(part, list.length === 0, "after the first hit");
    if (!list.length) return;
    const count = list.length > 1 ? `, ${list.length} hits of this point` : "";
    title(this.pulseBox, `Force pulse${count}`);
    title(this.spectrumBox, `Force spectrum re its maximum${count}`);
    title(this.responseBox, `Response of ${name} [${this.units[name] ?? ""}]${count}`);
    overlay(this.plots.pulse, list, (one) => one.pulse);
    overlay(this.plots.spectrum, list, (one) => one.spectrum);
    overlay(this.plots.response, list, (one) => ripple(one.responses[name]));
  }
}

/** @param {string} heading */
function box(heading) {
  return el("section", { class: "panel" }, el("h2", {}, heading), el("div", { class: "plot" }), el("p", { class: "note" }));
}

/** @param {HTMLElement} part */
function plotOf(part) {
  return /** @type {HTMLElement} */ (part.querySelector(".plot"));
}

/**
 * @param {HTMLElement} part
 * @param {string} text
 */
function title(part, text) {
  /** @type {HTMLElement} */ (part.querySelector("h2")).textContent = text;
}

/**
 * @param {HTMLElement} part
 * @param {boolean} isEmpty
 * @param {string} words
 */
function empty(part, isEmpty, words) {
  /** @type {HTMLElement} */ (part.querySelector(".note")).textContent = isEmpty ? words : "";
}

/**
 * Draw the hits over each other, the last one on top; a rejected one in its colour.
 * @param {import("./curves.js").CurvePlot} plot
 * @param {any[]} list
 * @param {(one: any) => number[][]} pick abscissa and ordinate
 */
function overlay(plot, list, pick) {
  const last = list.length - 1;
  const rows = list.map(pick);
  const x = [...new Set(rows.flatMap((row) => row[0]))].sort((a, b) => a - b);
  const data = rows.map(([at, values]) => {
    const known = new Map(at.map((one, i) => [one, values[i]]));
    return x.map((one) => known.get(one) ?? null);
  });
  plot.show([x, ...data], list.map((one, i) => ({
    name: `hit ${one.hit + 1}`,
    colour: i < last ? "curve-old" : one.good ? "curve-1" : "refused",
    width: i < last ? 1 : 2,
  })));
}

/**
 * Return smallest and largest values as one line that touches both.
 * @param {number[][] | undefined} row
 */
function ripple(row) {
  if (!row) return [[], []];
  const [time, low, high] = row;
  const step = time.length > 1 ? (time[1] - time[0]) / 2 : 0;
  return [
    time.flatMap((at) => [at, at + step]),
    time.flatMap((_, i) => [low[i], high[i]]),
  ];
}

/**
 * @param {number} low
 * @param {number} high
 * @param {number} count
 */
function steps(low, high, count) {
  return Array.from({ length: count }, (_, i) => low + ((i + 0.5) * (high - low)) / count);
}
