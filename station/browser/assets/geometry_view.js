// SPDX-License-Identifier: MIT
/** The points where they are, coloured by state: canvas 2-D, turned by keys or mouse. */

import { el, say } from "./dom.js";
import { colour, onTheme } from "./theme.js";

/** @type {Record<string, string>} */
const COLOURS = { done: "good", incomplete: "refused", now: "accent", open: "soft" };

export class GeometryView {
  constructor() {
    this.canvas = /** @type {HTMLCanvasElement} */ (el("canvas", {
      class: "geometry", tabindex: 0, role: "img",
      "aria-label": "Points of the plan, coloured by state; arrow keys turn the drawing",
    }));
    this.note = el("p", { class: "note" });
    /** @type {{points: Record<string, number[]>, lines: string[][], unit: string} | null} */
    this.geometry = null;
    /** @type {Map<string, string>} */
    this.marks = new Map();
    this.turn = 0.6;
    this.tilt = 0.5;
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons !== 1) return;
      this.turn += event.movementX / 120;
      this.tilt = Math.max(-1.5, Math.min(1.5, this.tilt + event.movementY / 120));
      this.draw();
    });
    onTheme(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** @param {any} geometry */
  know(geometry) {
    this.geometry = geometry;
    this.draw();
  }

  /** @param {any} state */
  show(state) {
    const marks = new Map();
    const here = state.conditions.find((/** @type {any} */ one) => one.mark === "now");
    for (const one of state.conditions) {
      // The points of the present torque and level; of all of them before and after.
      if (here && (one.torque !== here.torque || one.level !== here.level)) continue;
      const known = marks.get(one.point);
      if (known === undefined || one.mark === "now" || (known === "done" && one.mark !== "done")) {
        if (known !== "now") marks.set(one.point, one.mark);
      }
    }
    const changed = JSON.stringify([...marks]) !== JSON.stringify([...this.marks]);
    this.marks = marks;
    if (changed) this.draw();
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const step = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    if (!step) return;
    event.preventDefault();
    this.turn += step[0];
    this.tilt = Math.max(-1.5, Math.min(1.5, this.tilt + step[1]));
    this.draw();
  }

  /** Return the positions: of the geometry file, or in a row where there is none. */
  places() {
    const given = this.geometry?.points;
    if (given) return new Map(Object.entries(given));
    return new Map([...this.marks.keys()].map((name, i) => [name, [i, 0, 0]]));
  }

  draw() {
    const { canvas } = this;
    const scale = window.devicePixelRatio || 1;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (!width) return;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.font = "600 14px system-ui, sans-serif";
    const seen = this.projected(width, height);
    pen.strokeStyle = colour("curve-old");
    pen.lineWidth = 1.5;
    for (const [from, to] of this.geometry?.lines ?? []) {
      const [a, b] = [seen.get(from), seen.get(to)];
      if (!a || !b) continue;
      pen.beginPath();
      pen.moveTo(a[0], a[1]);
      pen.lineTo(b[0], b[1]);
      pen.stroke();
    }
    for (const [name, at] of seen) {
      const mark = this.marks.get(name);
      pen.fillStyle = mark === undefined ? colour("curve-old") : colour(COLOURS[mark]);
      pen.beginPath();
      pen.arc(at[0], at[1], mark === undefined ? 3 : mark === "now" ? 10 : 7, 0, 2 * Math.PI);
      pen.fill();
      if (mark === undefined) continue;
      pen.fillStyle = colour("ink");
      pen.fillText(name, at[0] + 12, at[1] - 8);
    }
    say(this.note, this.geometry
      ? "green done, blue now, red incomplete, grey open; at the present torque; arrow keys or mouse turn it"
      : "green done, blue now, red incomplete, grey open; positions come from --geometry FILE");
  }

  /**
   * Return the points on the canvas, fitted to it.
   * @param {number} width
   * @param {number} height
   */
  projected(width, height) {
    const flat = new Map([...this.places()].map(([name, [x, y, z]]) => {
      if (!this.geometry) return [name, [x, y]];
      const east = x * Math.cos(this.turn) - y * Math.sin(this.turn);
      const north = x * Math.sin(this.turn) + y * Math.cos(this.turn);
      return [name, [east, -(z * Math.cos(this.tilt) + north * Math.sin(this.tilt))]];
    }));
    const all = [...flat.values()];
    const xs = all.map((at) => at[0]);
    const ys = all.map((at) => at[1]);
    const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const room = 34;
    const zoom = Math.min((width - 2 * room) / (right - left || 1), (height - 2 * room) / (bottom - top || 1));
    return new Map([...flat].map(([name, [x, y]]) => [name, [
      width / 2 + (x - (left + right) / 2) * zoom,
      height / 2 + (y - (top + bottom) / 2) * zoom,
    ]]));
  }
}
