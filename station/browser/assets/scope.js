// SPDX-License-Identifier: MIT
/** The live signals: smallest and largest value of each bin, drawn column by column.
 *
 * Bins come in blocks and with jitter. The page plays them out evenly, a fraction of a
 * second late, so that it draws more often than blocks come, and each draw is new.
 */

import { el, say } from "./dom.js";
import { shown } from "./numbers.js";
import { SignalRing } from "./signal_ring.js";
import { colour, onTheme } from "./theme.js";

const EVERY = 40; // [ms] between two draws
const WORDS_EVERY = 250; // [ms] between two changes of the numbers, which are read
const ROW = 62; // [px] of a channel
const WORDS = 18; // [px] of them above the signal
const PLOT = ROW - 22; // [px] of them for the signal
const TIME = 22; // [px] below

export class Scope extends SignalRing {
  constructor() {
    super();
    /** @type {((words: boolean) => void)[]} */
    this.listeners = [];
    this.draws = 0;
    this.due = false;
    this.next = 0;
    this.worded = -Infinity;
    onTheme(() => this.again());
    document.addEventListener("visibilitychange", () => this.again());
  }

  /** @param {ArrayBuffer} bytes */
  take(bytes) {
    this.put(bytes);
    this.later();
  }

  /** Draw everything again, new or not. */
  again() {
    this.worded = -Infinity;
    this.later();
  }

  /** Draw when it is time; a page that is not seen waits. */
  later() {
    if (this.due || document.hidden) return;
    this.due = true;
    const wait = this.next - performance.now();
    if (wait > 8) setTimeout(() => this.frame(), wait - 8); // the frame comes up to 16 ms later
    else this.frame();
  }

  frame() {
    requestAnimationFrame((now) => {
      this.due = false;
      this.next = Math.max(this.next + EVERY, now + EVERY / 2);
      const fresh = this.play(now);
      const words = now - this.worded >= WORDS_EVERY;
      if (fresh) this.draws += 1;
      if (words) this.worded = now;
      if (fresh || words) for (const listener of this.listeners) listener(words);
      if (this.waiting()) this.later();
    });
  }

  /**
   * Draw all channels below each other into an element.
   * @param {HTMLElement} parent
   */
  drawIn(parent) {
    const canvas = /** @type {HTMLCanvasElement} */ (
      el("canvas", { class: "scope", role: "img", "aria-label": "Live signals of the last two seconds, one row a channel" })
    );
    const rate = el("p", { class: "note", id: "scope-note" });
    parent.append(canvas, rate);
    const view = new ScopeView(this, canvas);
    this.listeners.push((words) => {
      view.draw(words);
      if (words) {
        say(rate, this.rate
          ? `last ${this.window} s at ${shown(this.rate / 1000)} kHz; each pixel shows the smallest and the largest value`
          : "no samples yet");
      }
      Object.assign(canvas, { draws: this.draws });
    });
    new ResizeObserver(() => {
      view.fit(parent.clientWidth);
      this.again();
    }).observe(parent);
  }
}

/** Writes pixels: a rectangle a bin would cost ten times as much without a GPU. */
class ScopeView {
  /**
   * @param {Scope} scope
   * @param {HTMLCanvasElement} canvas
   */
  constructor(scope, canvas) {
    this.scope = scope;
    this.canvas = canvas;
    this.pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { willReadFrequently: true }));
    this.width = 0;
    this.scale = 1;
    /** @type {ImageData | null} */
    this.image = null;
    this.pixels = new Uint32Array(0);
    this.rows = -1;
  }

  /** @param {number} inside width of the panel [px] */
  fit(inside) {
    this.width = Math.max(200, inside) - 28;
    this.rows = -1;
  }

  /** @param {boolean} words whether numbers and names are written again */
  draw(words) {
    const rows = this.scope.rings.length;
    if (rows !== this.rows) this.resize(rows);
    if (!this.image) return;
    for (let channel = 0; channel < rows; channel += 1) {
      const level = this.scope.level(channel);
      const reach = this.scope.reach(channel);
      this.columns(channel, reach, level.full ? "refused" : `curve-${(channel % 6) + 1}`);
      if (words) this.words(channel, reach, level.full);
    }
    if (words) this.time(rows * ROW);
  }

  /** @param {number} rows */
  resize(rows) {
    this.rows = rows;
    this.scale = window.devicePixelRatio || 1;
    const height = rows * ROW + TIME;
    this.canvas.width = Math.round(this.width * this.scale);
    this.canvas.height = Math.round(height * this.scale);
    this.canvas.style.width = `${this.width}px`;
    this.canvas.style.height = `${height}px`;
    const across = Math.round((this.width - 8) * this.scale);
    this.image = rows && across > 0 ? this.pen.createImageData(across, Math.round(PLOT * this.scale)) : null;
    this.pixels = new Uint32Array(this.image?.data.buffer ?? new ArrayBuffer(0));
    this.scope.worded = -Infinity;
  }

  /**
   * Write the signal of a channel; each column holds the bins that fall into it.
   * @param {number} channel
   * @param {{low: number, high: number}} reach
   * @param {string} name of the colour
   */
  columns(channel, reach, name) {
    const image = /** @type {ImageData} */ (this.image);
    const { width, height } = image;
    const { kept, size } = this.scope;
    const ring = this.scope.rings[channel];
    const range = this.scope.channels[channel]?.range ?? 0;
    const half = Math.max((reach.high - reach.low) / 2, 2e-4 * range, 1e-12) * 1.05;
    const perUnit = height / (2 * half);
    const top = (reach.high + reach.low) / 2 + half;
    const ink = packed(colour(name));
    const begin = this.scope.shown - kept; // number of the bin at the left edge
    this.pixels.fill(packed(colour("paper")));
    this.pixels.fill(packed(colour("grid")), (height - 1) * width);
    for (let x = 0; x < width; x += 1) {
      const from = Math.max(this.scope.first(), begin + Math.floor((x * kept) / width));
      const past = Math.max(begin + Math.floor(((x + 1) * kept) / width), from + 1);
      if (begin + Math.floor((x * kept) / width) < this.scope.first()) continue;
      let low = Infinity;
      let high = -Infinity;
      for (let bin = from; bin < past; bin += 1) {
        const k = 2 * (bin % size);
        if (ring[k] < low) low = ring[k];
        if (ring[k + 1] > high) high = ring[k + 1];
      }
      const first = Math.max(0, Math.floor((top - high) * perUnit));
      const last = Math.min(height - 1, Math.max(first, Math.ceil((top - low) * perUnit) - 1));
      for (let at = first * width + x; at <= last * width + x; at += width) this.pixels[at] = ink;
    }
    this.pen.putImageData(image, Math.round(4 * this.scale), Math.round((channel * ROW + WORDS) * this.scale));
  }

  /**
   * @param {number} channel
   * @param {{low: number, high: number}} reach
   * @param {boolean} full
   */
  words(channel, reach, full) {
    const known = this.scope.channels[channel];
    const pen = this.plain(channel * ROW, WORDS);
    pen.fillStyle = colour("ink");
    pen.textAlign = "left";
    pen.fillText(known?.name ?? "", 4, channel * ROW + 12);
    pen.fillStyle = full ? colour("refused") : colour("soft");
    pen.textAlign = "right";
    pen.fillText(
      this.scope.count ? `${shown(reach.low, 3)} to ${shown(reach.high, 3)} ${known?.si ?? ""}${full ? "  OVERLOAD" : ""}` : "",
      this.width - 4, channel * ROW + 12,
    );
  }

  /** @param {number} top */
  time(top) {
    const pen = this.plain(top, TIME);
    const across = this.width - 8;
    pen.fillStyle = colour("soft");
    for (const share of [0, 0.25, 0.5, 0.75, 1]) {
      pen.textAlign = share === 0 ? "left" : share === 1 ? "right" : "center";
      pen.fillText(`${shown((share - 1) * this.scope.window, 3)} s`, 4 + share * across, top + 14);
    }
  }

  /**
   * Clear a strip, and return the pen for words.
   * @param {number} top
   * @param {number} high
   */
  plain(top, high) {
    const { pen } = this;
    pen.setTransform(this.scale, 0, 0, this.scale, 0, 0);
    pen.clearRect(0, top, this.width, high);
    pen.font = "12px system-ui, sans-serif";
    return pen;
  }
}

/**
 * Return a colour of the palette as a pixel, red in the lowest byte.
 * @param {string} value `"#1c2733"`
 */
function packed(value) {
  const rgb = Number.parseInt(value.slice(1), 16);
  return (0xff000000 | ((rgb & 0xff) << 16) | (rgb & 0xff00) | (rgb >> 16)) >>> 0;
}
