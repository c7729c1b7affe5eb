// SPDX-License-Identifier: MIT
/** The stabilisation diagram on a canvas: hover, click, box, zoom and keys. */

import { el } from "./dom.js";
import { shown } from "./numbers.js";
import { colour, onTheme } from "./theme.js";

const LEFT = 46;
const RIGHT = 14;
const TOP = 38;
const BOTTOM = 44;
const NEAR = 14;
const MARKS = ["dot", "ring", "triangle", "disc"];
const COLOURS = ["soft", "curve-2", "curve-4", "curve-3"];
export const MARK_WORDS = [
  "not stable", "stable in frequency", "stable in frequency and damping",
  "stable in frequency, damping and shape",
];

/**
 * @typedef {object} Diagram
 * @property {number[]} frequency_hz
 * @property {number[]} damping_ratio
 * @property {number[]} order
 * @property {number[]} stable
 * @property {number[]} track
 * @property {[number, number]} orders
 * @property {number[]} line_hz
 * @property {(number | null)[]} mean
 * @property {(number | null)[][]} cmif
 * @property {string} unit
 */

/** @typedef {{frequency_hz: number, pinned: boolean, by_hand: boolean}} Line */

export class PoleChart {
  /**
   * @param {HTMLElement} parent
   * @param {Diagram} diagram
   * @param {{
   *   choose: (row: number) => void,
   *   pin: (row: number) => void,
   *   clear: (low: number, high: number) => void,
   *   look: (row: number | null) => void,
   * }} to
   */
  constructor(parent, diagram, to) {
    this.diagram = diagram;
    this.to = to;
    /** @type {Line[]} */
    this.lines = [];
    this.indicator = "mean";
    /** @type {number | null} */
    this.at = null;
    /** @type {{x: number, y: number, tox: number, zoom: boolean} | null} */
    this.box = null;
    const all = diagram.line_hz;
    this.whole = [all[0], all[all.length - 1]];
    this.view = [...this.whole];
    this.canvas = /** @type {HTMLCanvasElement} */ (el("canvas", {
      class: "pole-chart", tabindex: 0, role: "application",
      "aria-label": "Stabilisation diagram. Arrow keys move between poles and orders, "
        + "Enter chooses, P pins, Delete clears, plus and minus zoom, 0 shows all.",
    }));
    parent.append(this.canvas);
    this.width = 600;
    this.height = 420;
    new ResizeObserver(() => this.resize(parent)).observe(parent);
    onTheme(() => this.later());
    this.listen();
  }

  /** @param {HTMLElement} parent */
  resize(parent) {
    this.width = Math.max(260, parent.clientWidth);
    this.height = this.width < 500 ? 340 : 440;
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.canvas.style.width = `${this.width}px`;
    this.canvas.style.height = `${this.height}px`;
    this.draw();
  }

  /** @param {Line[]} lines the chosen modes */
  choose(lines) {
    this.lines = lines;
    this.later();
  }

  /** @param {string} name of what is drawn behind the poles */
  indicate(name) {
    this.indicator = name;
    this.later();
  }

  later() {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.draw();
    });
  }

  /** @param {number} hertz */
  x(hertz) {
    const [low, high] = this.view;
    return LEFT + ((hertz - low) / (high - low)) * (this.width - LEFT - RIGHT);
  }

  /** @param {number} order */
  y(order) {
    const [low, high] = this.diagram.orders;
    return this.height - BOTTOM - 8 - ((order - low) / Math.max(1, high - low)) * (this.height - TOP - BOTTOM - 16);
  }

  /** @param {number} x */
  hertz(x) {
    const [low, high] = this.view;
    return low + ((x - LEFT) / (this.width - LEFT - RIGHT)) * (high - low);
  }

  /**
   * Return the pole nearest to a place, or null.
   * @param {number} x
   * @param {number} y
   */
  near(x, y) {
    let best = null;
    let least = NEAR;
    this.diagram.frequency_hz.forEach((hertz, row) => {
      const away = Math.hypot(this.x(hertz) - x, this.y(this.diagram.order[row]) - y);
      if (away < least) {
        least = away;
        best = row;
      }
    });
    return /** @type {number | null} */ (best);
  }

  /** @param {number | null} row */
  look(row) {
    if (row === this.at) return;
    this.at = row;
    this.to.look(row);
    this.later();
  }

  /**
   * Zoom around a frequency.
   * @param {number} factor
   * @param {number} [middle]
   */
  zoom(factor, middle) {
    const [low, high] = this.view;
    const at = middle ?? (this.at === null ? (low + high) / 2 : this.diagram.frequency_hz[this.at]);
    this.show(at - (at - low) * factor, at + (high - at) * factor);
  }

  /**
   * @param {number} low
   * @param {number} high
   */
  show(low, high) {
    const [first, last] = this.whole;
    const least = (last - first) / 1e4;
    if (high - low < least) return;
    this.view = [Math.max(first, low), Math.min(last, high)];
    this.later();
  }

  listen() {
    const canvas = this.canvas;
    const place = (/** @type {PointerEvent | WheelEvent | MouseEvent} */ event) => {
      const edge = canvas.getBoundingClientRect();
      return [event.clientX - edge.left, event.clientY - edge.top];
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      const [x, y] = place(event);
      this.box = { x, y, tox: x, zoom: event.shiftKey };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const [x, y] = place(event);
      if (this.box) {
        this.box.tox = x;
        this.later();
      } else {
        this.look(this.near(x, y));
      }
    });
    canvas.addEventListener("pointerup", (event) => {
      const [x, y] = place(event);
      const box = this.box;
      this.box = null;
      this.later();
      if (!box) return;
      if (Math.abs(x - box.x) < 5) {
        const row = this.near(x, y);
        if (row !== null) this.to.choose(row);
        return;
      }
      const ends = [this.hertz(box.x), this.hertz(x)].sort((a, b) => a - b);
      if (box.zoom) this.show(ends[0], ends[1]);
      else this.to.clear(ends[0], ends[1]);
    });
    canvas.addEventListener("pointercancel", () => {
      this.box = null;
      this.later();
    });
    canvas.addEventListener("pointerleave", () => {
      if (!this.box && document.activeElement !== canvas) this.look(null);
    });
    canvas.addEventListener("dblclick", () => this.show(this.whole[0], this.whole[1]));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.25 : 0.8, this.hertz(place(event)[0]));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const [low, high] = this.view;
    const moves = /** @type {Record<string, () => void>} */ ({
      ArrowRight: () => this.step(1),
      ArrowLeft: () => this.step(-1),
      ArrowUp: () => this.climb(1),
      ArrowDown: () => this.climb(-1),
      Enter: () => this.at !== null && this.to.choose(this.at),
      p: () => this.at !== null && this.to.pin(this.at),
      Delete: () => this.drop(),
      Backspace: () => this.drop(),
      "+": () => this.zoom(0.6),
      "-": () => this.zoom(1 / 0.6),
      0: () => this.show(this.whole[0], this.whole[1]),
      PageDown: () => this.show(low + (high - low) / 2, high + (high - low) / 2),
      PageUp: () => this.show(low - (high - low) / 2, high - (high - low) / 2),
    });
    const move = moves[event.key];
    if (!move) return;
    event.preventDefault();
    move();
  }

  /**
   * Move to the next pole of the same order.
   * @param {number} way 1 or -1
   */
  step(way) {
    const { frequency_hz: hertz, order } = this.diagram;
    const now = this.at ?? this.start();
    if (this.at === null) return this.look(now);
    const rows = order.map((_, i) => i).filter((i) => order[i] === order[now]);
    rows.sort((a, b) => hertz[a] - hertz[b]);
    const next = rows[rows.indexOf(now) + way];
    if (next === undefined) return;
    this.keep(next);
  }

  /**
   * Move to the nearest pole of the next order.
   * @param {number} way 1 or -1
   */
  climb(way) {
    const { frequency_hz: hertz, order } = this.diagram;
    if (this.at === null) return this.look(this.start());
    const now = this.at;
    const further = order.filter((one) => (one - order[now]) * way > 0);
    if (!further.length) return;
    const wanted = way > 0 ? Math.min(...further) : Math.max(...further);
    let best = now;
    let least = Infinity;
    order.forEach((one, i) => {
      const away = Math.abs(hertz[i] - hertz[now]);
      if (one === wanted && away < least) {
        least = away;
        best = i;
      }
    });
    this.keep(best);
  }

  /** Return the pole at which keys begin: the first of the highest order in view. */
  start() {
    const { frequency_hz: hertz, order } = this.diagram;
    let best = 0;
    order.forEach((one, i) => {
      const inside = hertz[i] >= this.view[0] && hertz[i] <= this.view[1];
      if (inside && (one > order[best] || (one === order[best] && hertz[i] < hertz[best]))) best = i;
    });
    return best;
  }

  /**
   * Look at a pole, and have it in view.
   * @param {number} row
   */
  keep(row) {
    const hertz = this.diagram.frequency_hz[row];
    const [low, high] = this.view;
    if (hertz < low || hertz > high) {
      const half = (high - low) / 2;
      this.show(hertz - half, hertz + half);
    }
    this.look(row);
  }

  /** Clear the chosen pole nearest to the one looked at. */
  drop() {
    if (this.at === null || !this.lines.length) return;
    const hertz = this.diagram.frequency_hz[this.at];
    const near = this.lines.reduce((a, b) => (
      Math.abs(a.frequency_hz - hertz) <= Math.abs(b.frequency_hz - hertz) ? a : b));
    const reach = near.frequency_hz * 1e-6;
    this.to.clear(near.frequency_hz - reach, near.frequency_hz + reach);
  }

  draw() {
    const context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    context.font = "13px system-ui, sans-serif";
    this.axes(context);
    context.save();
    context.beginPath();
    context.rect(LEFT, TOP - 28, this.width - LEFT - RIGHT, this.height - TOP - BOTTOM + 28);
    context.clip();
    this.curves(context);
    this.modes(context);
    this.diagram.frequency_hz.forEach((hertz, row) => {
      if (hertz >= this.view[0] && hertz <= this.view[1]) this.mark(context, row);
    });
    this.drawBox(context);
    context.restore();
  }

  /** @param {CanvasRenderingContext2D} context */
  axes(context) {
    const right = this.width - RIGHT;
    const bottom = this.height - BOTTOM;
    context.lineWidth = 1;
    context.strokeStyle = colour("grid");
    context.fillStyle = colour("soft");
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const hertz of ticks(this.view[0], this.view[1], Math.max(3, (right - LEFT) / 90))) {
      const x = Math.round(this.x(hertz)) + 0.5;
      context.beginPath();
      context.moveTo(x, TOP - 28);
      context.lineTo(x, bottom);
      context.stroke();
      context.fillText(shown(hertz, 7), x, bottom + 6);
    }
    context.fillText("frequency [Hz]", (LEFT + right) / 2, bottom + 24);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const order of ticks(this.diagram.orders[0], this.diagram.orders[1], 6)) {
      if (Number.isInteger(order)) context.fillText(String(order), LEFT - 6, this.y(order));
    }
    context.save();
    context.translate(10, (TOP + bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("model order", 0, 0);
    context.restore();
    context.strokeStyle = colour("line");
    context.strokeRect(LEFT + 0.5, TOP - 27.5, right - LEFT - 1, bottom - TOP + 28);
  }

  /** @param {CanvasRenderingContext2D} context */
  curves(context) {
    const rows = this.indicator === "cmif" ? this.diagram.cmif : [this.diagram.mean];
    const hertz = this.diagram.line_hz;
    const inside = rows.flatMap((row) => row.filter((value, i) => (
      value !== null && value > 0 && hertz[i] >= this.view[0] && hertz[i] <= this.view[1])));
    const logs = inside.map((value) => Math.log10(/** @type {number} */ (value)));
    const top = logs.reduce((a, b) => Math.max(a, b), -300);
    const low = Math.max(logs.reduce((a, b) => Math.min(a, b), 300), top - 6);
    const span = Math.max(1e-9, top - low);
    rows.forEach((row, number) => {
      context.strokeStyle = colour("curve-old");
      context.setLineDash(number ? [4, 3] : []);
      context.lineWidth = 1.3;
      context.beginPath();
      row.forEach((value, i) => {
        if (value === null || value <= 0) return;
        const share = (Math.log10(value) - low) / span;
        const y = this.height - BOTTOM - 6 - share * (this.height - TOP - BOTTOM - 12);
        context.lineTo(this.x(hertz[i]), y);
      });
      context.stroke();
    });
    context.setLineDash([]);
  }

  /** @param {CanvasRenderingContext2D} context */
  modes(context) {
    context.textBaseline = "bottom";
    context.textAlign = "center";
    let before = -100;
    let raised = false;
    this.lines.forEach((line, number) => {
      const x = this.x(line.frequency_hz);
      context.strokeStyle = colour("accent");
      context.fillStyle = colour("accent");
      context.lineWidth = line.by_hand ? 2 : 1.2;
      context.setLineDash(line.by_hand ? [] : [6, 4]);
      context.beginPath();
      context.moveTo(x, TOP + 2);
      context.lineTo(x, this.height - BOTTOM);
      context.stroke();
      context.setLineDash([]);
      // Numbers of close modes would cover each other.
      raised = !raised && x - before < 18;
      before = x;
      context.font = "600 12px system-ui, sans-serif";
      context.fillText(`${number + 1}${line.pinned ? " pin" : ""}`, x, TOP + 1 - (raised ? 13 : 0));
    });
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {number} row
   */
  mark(context, row) {
    const level = this.diagram.stable[row];
    const x = this.x(this.diagram.frequency_hz[row]);
    const y = this.y(this.diagram.order[row]);
    context.strokeStyle = context.fillStyle = colour(COLOURS[level]);
    context.lineWidth = 1.4;
    context.beginPath();
    if (MARKS[level] === "dot") {
      context.rect(x - 1, y - 1, 2, 2);
      context.fill();
    } else if (MARKS[level] === "ring") {
      context.arc(x, y, 3, 0, 7);
      context.stroke();
    } else if (MARKS[level] === "triangle") {
      context.moveTo(x, y - 4);
      context.lineTo(x + 3.6, y + 2.6);
      context.lineTo(x - 3.6, y + 2.6);
      context.closePath();
      context.stroke();
    } else {
      context.arc(x, y, 3.2, 0, 7);
      context.fill();
    }
    if (row === this.at) {
      context.strokeStyle = colour("ink");
      context.lineWidth = 2;
      context.beginPath();
      context.arc(x, y, 7.5, 0, 7);
      context.stroke();
    }
  }

  /** @param {CanvasRenderingContext2D} context */
  drawBox(context) {
    if (!this.box || Math.abs(this.box.tox - this.box.x) < 5) return;
    const left = Math.min(this.box.x, this.box.tox);
    const width = Math.abs(this.box.tox - this.box.x);
    context.globalAlpha = 0.18;
    context.fillStyle = colour(this.box.zoom ? "accent" : "refused");
    context.fillRect(left, TOP - 28, width, this.height);
    context.globalAlpha = 1;
    context.strokeStyle = colour(this.box.zoom ? "accent" : "refused");
    context.strokeRect(left, TOP - 28, width, this.height);
    context.fillStyle = colour("ink");
    context.textBaseline = "top";
    context.textAlign = "center";
    context.fillText(this.box.zoom ? "show" : "clear", left + width / 2, TOP + 4);
  }
}

/**
 * Return round numbers within a range.
 * @param {number} low
 * @param {number} high
 * @param {number} most
 */
export function ticks(low, high, most) {
  const raw = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= raw) ?? raw;
  const found = [];
  for (let n = Math.ceil(low / step); n * step <= high; n += 1) found.push(Number((n * step).toPrecision(12)));
  return found;
}
