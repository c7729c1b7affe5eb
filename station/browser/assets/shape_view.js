// SPDX-License-Identifier: MIT
/** A mode shape that moves, on a canvas: turned by dragging or with the arrow keys. */

import { el } from "./dom.js";
import { colour, onTheme } from "./theme.js";

const SWING = 0.2;
const TURNS_A_SECOND = 0.7;

export class ShapeView {
  /**
   * @param {HTMLElement} parent
   * @param {{names: string[], place: number[][], lines: number[][]}} drawn
   */
  constructor(parent, drawn) {
    this.drawn = drawn;
    /** @type {{re: number[][], im: number[][]} | null} */
    this.mode = null;
    this.angle = [-0.6, 0.5];
    this.playing = !window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.phase = 0;
    this.size = 1;
    this.last = 0;
    this.frames = 0;
    this.canvas = /** @type {HTMLCanvasElement} */ (el("canvas", {
      tabindex: 0, role: "img", class: "shape-view",
      "aria-label": "Mode shape in motion. Arrow keys turn it, space stops it.",
    }));
    parent.append(this.canvas);
    this.width = 300;
    this.height = 300;
    this.fit();
    new ResizeObserver(() => {
      const ratio = window.devicePixelRatio || 1;
      this.width = Math.max(220, parent.clientWidth);
      this.height = Math.min(460, Math.max(260, 0.62 * this.width));
      this.canvas.width = Math.round(this.width * ratio);
      this.canvas.height = Math.round(this.height * ratio);
      this.canvas.style.width = `${this.width}px`;
      this.canvas.style.height = `${this.height}px`;
      this.draw();
    }).observe(parent);
    onTheme(() => this.draw());
    this.listen();
    requestAnimationFrame((time) => this.frame(time));
  }

  /** Find the middle and the size of what is drawn. */
  fit() {
    const { place } = this.drawn;
    this.middle = [0, 1, 2].map((axis) => {
      const values = place.map((one) => one[axis]);
      return (Math.min(...values) + Math.max(...values)) / 2;
    });
    this.reach = Math.max(...place.map((one) => (
      Math.hypot(...one.map((value, axis) => value - /** @type {number[]} */ (this.middle)[axis])))), 1e-9);
  }

  /** @param {{re: number[][], im: number[][]}} mode */
  show(mode) {
    this.mode = mode;
    this.draw();
  }

  /** @param {number} time [ms] */
  frame(time) {
    const passed = Math.min(100, time - this.last) / 1000;
    this.last = time;
    if (this.playing && !document.hidden) {
      this.phase += 2 * Math.PI * TURNS_A_SECOND * passed;
      this.draw();
    }
    requestAnimationFrame((next) => this.frame(next));
  }

  toggle() {
    this.playing = !this.playing;
    return this.playing;
  }

  listen() {
    /** @type {number[] | null} */
    let from = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      from = [event.clientX, event.clientY];
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      this.turn((event.clientX - from[0]) / 120, (event.clientY - from[1]) / 120);
      from = [event.clientX, event.clientY];
    });
    this.canvas.addEventListener("pointerup", () => {
      from = null;
    });
    this.canvas.addEventListener("keydown", (event) => {
      const turns = /** @type {Record<string, [number, number]>} */ ({
        ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15],
      });
      const turn = turns[event.key];
      if (!turn) return;
      event.preventDefault();
      this.turn(...turn);
    });
  }

  /**
   * @param {number} around
   * @param {number} over
   */
  turn(around, over) {
    this.angle = [this.angle[0] + around, Math.max(-1.5, Math.min(1.5, this.angle[1] + over))];
    this.draw();
  }

  /**
   * Project a point.
   * @param {number[]} point
   */
  project(point) {
    const [a, b] = this.angle;
    const [x, y, z] = point.map((value, axis) => (
      (value - /** @type {number[]} */ (this.middle)[axis]) / /** @type {number} */ (this.reach)));
    const across = x * Math.cos(a) - y * Math.sin(a);
    const deep = x * Math.sin(a) + y * Math.cos(a);
    const up = z * Math.cos(b) + deep * Math.sin(b);
    const scale = Math.min(this.width, this.height * 1.5) * 0.4;
    return [this.width / 2 + across * scale, this.height / 2 - up * scale];
  }

  draw() {
    const context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    this.wire(context, this.drawn.place, "curve-old", 1.2);
    if (!this.mode) return;
    const { re, im } = this.mode;
    const [c, s] = [Math.cos(this.phase), Math.sin(this.phase)];
    const swing = SWING * this.size * 2 * /** @type {number} */ (this.reach);
    const moved = this.drawn.place.map((one, i) => one.map((value, axis) => (
      value + swing * (re[i][axis] * c - im[i][axis] * s))));
    this.wire(context, moved, "curve-1", 2.4);
    this.names(context, moved);
    this.frames += 1;
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {number[][]} places
   * @param {string} hue
   * @param {number} width
   */
  wire(context, places, hue, width) {
    const flat = places.map((one) => this.project(one));
    context.strokeStyle = context.fillStyle = colour(hue);
    context.lineWidth = width;
    context.beginPath();
    for (const [one, other] of this.drawn.lines) {
      context.moveTo(flat[one][0], flat[one][1]);
      context.lineTo(flat[other][0], flat[other][1]);
    }
    context.stroke();
    for (const [x, y] of flat) {
      context.beginPath();
      context.arc(x, y, 1.6 * width, 0, 7);
      context.fill();
    }
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {number[][]} places
   */
  names(context, places) {
    if (places.length > 60) return;
    context.fillStyle = colour("ink");
    context.font = "600 13px system-ui, sans-serif";
    places.forEach((one, i) => {
      const [x, y] = this.project(one);
      context.fillText(this.drawn.names[i], x + 7, y - 7);
    });
  }
}
