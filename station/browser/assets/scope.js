// SPDX-License-Identifier: MIT
/** The live signals: smallest and largest value of each bin, drawn one pixel wide. */

import { el, say } from "./dom.js";
import { shown } from "./numbers.js";
import { colour, curveColour, onTheme } from "./theme.js";

const HEAD = 16;
const LEVEL = 0.5;
const NEAR_FULL = 0.98;

export class Scope {
  constructor() {
    this.kept = 800;
    this.past = 0;
    this.count = 0;
    this.perBin = 0;
    this.rate = 0;
    this.window = 2;
    /** @type {{name: string, si: string, range: number | null, quantity: string}[]} */
    this.channels = [];
    /** @type {Float32Array[]} per channel, smallest and largest in turn, as a ring */
    this.rings = [];
    /** @type {(() => void)[]} */
    this.listeners = [];
    this.draws = 0;
    this.due = false;
    onTheme(() => this.later());
  }

  /** @param {any} state */
  know(state) {
    this.channels = state.channels;
    this.rate = state.begun?.sample_rate ?? 0;
    this.window = state.window;
  }

  /** @param {ArrayBuffer} bytes */
  take(bytes) {
    const [first, count, channels, perBin] = new Uint32Array(bytes, 0, 4);
    const values = new Float32Array(bytes, HEAD);
    if (this.rings.length !== channels || first < this.past - this.kept || this.perBin !== perBin) {
      this.rings = Array.from({ length: channels }, () => new Float32Array(2 * this.kept));
      this.count = 0;
    } else if (first !== this.past) {
      this.count = 0;
    }
    this.perBin = perBin;
    for (let channel = 0; channel < channels; channel += 1) {
      const ring = this.rings[channel];
      for (let bin = 0; bin < count; bin += 1) {
        const to = 2 * ((first + bin) % this.kept);
        const from = 2 * (channel * count + bin);
        ring[to] = values[from];
        ring[to + 1] = values[from + 1];
      }
    }
    this.past = first + count;
    this.count = Math.min(this.kept, this.count + count);
    this.later();
  }

  later() {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.draws += 1;
      for (const listener of this.listeners) listener();
    });
  }

  /**
   * Return the largest value of the last half second, and whether it fills the range.
   * @param {number} channel
   */
  level(channel) {
    const bins = this.perBin ? Math.ceil((LEVEL * this.rate) / this.perBin) : 0;
    const ring = this.rings[channel];
    let largest = 0;
    let squares = 0;
    const from = Math.max(this.past - this.count, this.past - bins);
    for (let bin = from; ring && bin < this.past; bin += 1) {
      const at = 2 * (bin % this.kept);
      largest = Math.max(largest, -ring[at], ring[at + 1]);
      squares += 1;
    }
    const range = this.channels[channel]?.range ?? 0;
    const share = range ? largest / range : 0;
    return { largest, share, full: share >= NEAR_FULL, known: squares > 0 };
  }

  /**
   * Draw all channels below each other into an element.
   * @param {HTMLElement} parent
   */
  drawIn(parent) {
    const canvas = /** @type {HTMLCanvasElement} */ (
      el("canvas", { role: "img", "aria-label": "Live signals of the last two seconds, one row a channel" })
    );
    const rate = el("p", { class: "note", id: "scope-note" });
    parent.append(canvas, rate);
    this.listeners.push(() => {
      this.draw(canvas);
      say(rate, this.rate
        ? `last ${this.window} s at ${shown(this.rate / 1000)} kHz; each pixel shows the smallest and the largest value`
        : "no samples yet");
      canvas.dataset.draws = String(this.draws);
    });
    new ResizeObserver(() => this.later()).observe(parent);
  }

  /** @param {HTMLCanvasElement} canvas */
  draw(canvas) {
    const scale = window.devicePixelRatio || 1;
    const width = Math.max(200, canvas.parentElement?.clientWidth ?? 200) - 28;
    const row = 62;
    const rows = this.rings.length;
    const height = rows * row + 22;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
      canvas.style.width = `${width}px`;
      canvas.style.height = `${height}px`;
    }
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    const left = 4;
    const across = width - left - 4;
    for (let channel = 0; channel < rows; channel += 1) {
      this.drawRow(pen, channel, { left, top: channel * row, across, high: row });
    }
    this.drawTime(pen, left, across, rows * row);
  }

  /**
   * @param {CanvasRenderingContext2D} pen
   * @param {number} channel
   * @param {{left: number, top: number, across: number, high: number}} at
   */
  drawRow(pen, channel, at) {
    const ring = this.rings[channel];
    const first = this.past - this.count;
    let low = Infinity;
    let high = -Infinity;
    for (let bin = first; bin < this.past; bin += 1) {
      const k = 2 * (bin % this.kept);
      low = Math.min(low, ring[k]);
      high = Math.max(high, ring[k + 1]);
    }
    const middle = (low + high) / 2;
    const range = this.channels[channel]?.range ?? 0;
    const half = Math.max((high - low) / 2, 2e-4 * range, 1e-12) * 1.05;
    const plotTop = at.top + 18;
    const plotHigh = at.high - 22;
    pen.strokeStyle = colour("grid");
    pen.beginPath();
    pen.moveTo(at.left, plotTop + plotHigh + 1.5);
    pen.lineTo(at.left + at.across, plotTop + plotHigh + 1.5);
    pen.stroke();
    const level = this.level(channel);
    pen.fillStyle = level.full ? colour("bad-ink") : curveColour(channel);
    const step = at.across / this.kept;
    const begin = this.kept - this.count;
    for (let bin = 0; bin < this.count; bin += 1) {
      const k = 2 * ((first + bin) % this.kept);
      const top = plotTop + plotHigh * (0.5 - (ring[k + 1] - middle) / (2 * half));
      const bottom = plotTop + plotHigh * (0.5 - (ring[k] - middle) / (2 * half));
      pen.fillRect(at.left + (begin + bin) * step, top, Math.max(step, 1), Math.max(1, bottom - top));
    }
    const known = this.channels[channel];
    const unit = known?.si ?? "";
    pen.fillStyle = colour("ink");
    pen.textAlign = "left";
    pen.fillText(known?.name ?? "", at.left, at.top + 12);
    pen.fillStyle = level.full ? colour("bad-ink") : colour("soft");
    pen.textAlign = "right";
    pen.fillText(
      this.count ? `${shown(low, 3)} to ${shown(high, 3)} ${unit}${level.full ? "  OVERLOAD" : ""}` : "",
      at.left + at.across, at.top + 12,
    );
  }

  /**
   * @param {CanvasRenderingContext2D} pen
   * @param {number} left
   * @param {number} across
   * @param {number} top
   */
  drawTime(pen, left, across, top) {
    pen.fillStyle = colour("soft");
    for (const share of [0, 0.25, 0.5, 0.75, 1]) {
      pen.textAlign = share === 0 ? "left" : share === 1 ? "right" : "center";
      pen.fillText(`${shown((share - 1) * this.window, 3)} s`, left + share * across, top + 14);
    }
  }
}
