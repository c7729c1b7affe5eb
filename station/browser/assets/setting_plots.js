// SPDX-License-Identifier: MIT
/** What trial hits proposed, as lines in the last hit; some of them can be moved. */

import { curvePlot } from "./curves.js";
import { el, fill } from "./dom.js";
import { shown } from "./numbers.js";

/**
 * @typedef {object} Line
 * @property {string} name of the setting
 * @property {string} words
 * @property {"x" | "y"} across scale that it is a value of
 * @property {number} unit value of the scale for one of the setting
 * @property {string} symbol
 * @property {boolean} moves whether the operator may change it
 */

/** @type {Record<string, Line[]>} */
const LINES = {
  pulse: [
    { name: "trigger_n", words: "trigger level", across: "y", unit: 1, symbol: "N", moves: true },
    { name: "force_window_s", words: "end of the force window", across: "x", unit: 1000, symbol: "ms", moves: false },
  ],
  spectrum: [{ name: "band_hz", words: "upper end of the band", across: "x", unit: 1, symbol: "Hz", moves: false }],
  response: [{ name: "length_s", words: "length of a record", across: "x", unit: 1000, symbol: "ms", moves: true }],
};

export class SettingPlots {
  constructor() {
    /** @type {Record<string, {plot: import("./curves.js").CurvePlot, over: HTMLElement, list: HTMLElement}>} */
    this.parts = {};
    /** @type {Map<string, HTMLElement>} */
    this.handles = new Map();
    /** @type {any} */
    this.state = null;
    this.dragged = "";
    /** @type {(name: string, value: number) => void} */
    this.change = () => undefined;
    this.rest = el("div");
    this.box = el("section", { "aria-label": "Proposals" });
  }

  /** @param {(name: string, value: number) => void} change takes a moved setting */
  build(change) {
    this.change = change;
    const titles = { pulse: "Trigger and force window", spectrum: "Band", response: "Length of a record" };
    const axes = {
      pulse: { x: "time after the trigger [ms]", y: "force [N]", label: "Force of the last hit with trigger level and force window" },
      spectrum: { x: "frequency [Hz]", y: "force [dB]", label: "Force spectrum of the last hit with the end of the band" },
      response: { x: "time after the trigger [ms]", y: "share of the peak [-]", xRoom: 0.12, label: "Responses to the last hit with the length of a record" },
    };
    fill(this.box, el("div", { class: "grid" }, ...Object.keys(LINES).map((key) => {
      const name = /** @type {keyof titles} */ (key);
      const over = el("div", { class: "plot" });
      const list = el("div");
      const panel = el("section", { class: "panel" }, el("h2", {}, titles[name]), over, list);
      queueMicrotask(() => {
        const plot = curvePlot(over, {
          ...axes[name], curves: [{ name: "last hit", colour: "curve-1" }],
          hooks: { draw: [() => this.place(name)] },
        });
        this.parts[name] = { plot, over, list };
        for (const line of LINES[name]) this.handle(name, line);
      });
      return panel;
    })), el("section", { class: "panel" }, el("h2", {}, "Further proposals"), this.rest));
  }

  /** @param {any} picture of the last hit */
  picture(picture) {
    this.parts.pulse?.plot.show(picture.pulse);
    this.parts.spectrum?.plot.show(picture.spectrum);
    const rows = /** @type {number[][][]} */ (Object.values(picture.responses));
    if (!rows.length) return;
    const size = rows[0][1].map((_, i) => Math.max(...rows.map(([, low, high]) =>
      Math.max(-low[i], high[i]) / Math.max(...high, ...low.map((v) => -v), 1e-30))));
    this.parts.response?.plot.show([rows[0][0], size]);
  }

  /** @param {any} state */
  show(state) {
    this.state = state;
    for (const [name, part] of Object.entries(this.parts)) {
      fill(part.list, ...LINES[name].map((line) => {
        const found = this.setting(line.name);
        return el("p", { class: "note" }, found
          ? [line.words, ": "].join("") : `${line.words}: after the trial hits`,
          found ? el("b", {}, `${shown(found.value * line.unit)} ${line.symbol}`) : null,
          found ? `  (${found.reason})` : null);
      }));
      this.place(name);
    }
    const drawn = new Set(Object.values(LINES).flat().map((line) => line.name));
    const others = state.settings.filter((/** @type {any} */ one) => !drawn.has(one.name));
    fill(this.rest, ...(others.length ? others.map((/** @type {any} */ one) =>
      el("p", { class: "note" }, `${this.words(one.name)}: `, el("b", {}, `${shown(one.value)} ${this.symbol(one.name)}`), `  (${one.reason})`)) :
      [el("p", { class: "note" }, "ranges and windows follow from the trial hits")]));
  }

  /** @param {string} name of a setting without a line */
  words(name) {
    if (name === "decay_rate_per_s") return "decay rate of the exponential window";
    return name.startsWith("range_") ? `range of ${name.slice("range_".length)}` : name;
  }

  /** @param {string} name of a setting without a line */
  symbol(name) {
    if (name === "decay_rate_per_s") return "1/s";
    return this.state?.channels.find((/** @type {any} */ one) => `range_${one.name}` === name)?.si ?? "";
  }

  /** @param {string} name */
  setting(name) {
    return this.state?.settings.find((/** @type {any} */ one) => one.name === name) ?? null;
  }

  /**
   * Make the line of a setting: a slider for those that can be moved.
   * @param {string} part
   * @param {Line} line
   */
  handle(part, line) {
    const { over, plot } = this.parts[part];
    const made = el("div", {
      class: `handle${line.across === "y" ? " level" : ""}${line.moves ? "" : " still"}`,
      ...(line.moves ? { role: "slider", tabindex: 0, "aria-label": line.words } : { "aria-hidden": "true" }),
    });
    made.hidden = true;
    const frame = /** @type {HTMLElement} */ (over.querySelector(".u-over"));
    frame.append(made);
    this.handles.set(line.name, made);
    if (!line.moves) return;
    /** @param {number} value */
    const move = (value) => {
      const found = this.setting(line.name);
      if (found) found.value = value;
      this.place(part);
    };
    made.addEventListener("pointerdown", (event) => {
      made.setPointerCapture(event.pointerId);
      this.dragged = line.name;
    });
    made.addEventListener("pointermove", (event) => {
      if (this.dragged !== line.name) return;
      const edge = frame.getBoundingClientRect();
      const at = line.across === "y" ? event.clientY - edge.top : event.clientX - edge.left;
      move(plot.plot().posToVal(at, line.across) / line.unit);
    });
    made.addEventListener("pointerup", () => {
      this.dragged = "";
      const found = this.setting(line.name);
      if (found) this.change(line.name, found.value);
    });
    made.addEventListener("keydown", (event) => {
      const factor = { ArrowUp: 1.05, ArrowRight: 1.05, ArrowDown: 1 / 1.05, ArrowLeft: 1 / 1.05 }[event.key];
      const found = this.setting(line.name);
      if (!factor || !found) return;
      event.preventDefault();
      move(found.value * factor);
      this.change(line.name, found.value);
    });
  }

  /** @param {string} part */
  place(part) {
    const known = this.parts[part];
    if (!known) return;
    const plot = known.plot.plot();
    for (const line of LINES[part]) {
      const made = this.handles.get(line.name);
      const found = this.setting(line.name);
      if (!made) continue;
      const at = found ? plot.valToPos(found.value * line.unit, line.across) : NaN;
      const most = line.across === "y" ? plot.over.clientHeight : plot.over.clientWidth;
      made.hidden = !Number.isFinite(at) || at < -2 || at > most + 2;
      if (made.hidden) continue;
      made.style[line.across === "y" ? "top" : "left"] = `${at}px`;
      made.setAttribute("aria-valuenow", shown(found.value * line.unit));
      made.setAttribute("aria-valuetext", `${shown(found.value * line.unit)} ${line.symbol}`);
      made.title = `${line.words} ${shown(found.value * line.unit)} ${line.symbol}`;
    }
  }
}
