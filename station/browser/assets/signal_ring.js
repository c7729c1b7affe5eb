// SPDX-License-Identifier: MIT
/** Bins of the signals as they came, and how far they have been played out. */

const HEAD = 16;
const LEVEL = 0.5; // [s] that a level is taken of
const NEAR_FULL = 0.98;
const LATE = 0.07; // [s] that is held back, over one block of the recorder and its jitter
const FAR = 0.5; // [s] behind which the page does not catch up but jumps
const PULL = 4; // [1/s] with which it returns to LATE
const SPARE = 256; // bins that may wait

export class SignalRing {
  constructor() {
    this.kept = 800;
    this.size = this.kept + SPARE;
    this.past = 0;
    this.shown = 0; // one past the last bin that is drawn
    this.place = 0; // the same, with its fraction
    this.count = 0; // bins in the ring
    this.perBin = 0;
    this.rate = 0;
    this.window = 2;
    this.played = 0;
    /** @type {{name: string, si: string, range: number | null, quantity: string}[]} */
    this.channels = [];
    /** @type {Float32Array[]} per channel, smallest and largest in turn, as a ring */
    this.rings = [];
  }

  /** @param {any} state */
  know(state) {
    this.channels = state.channels;
    this.rate = state.begun?.sample_rate ?? 0;
    this.window = state.window;
  }

  /**
   * Take bins as envelope_ring.py writes them.
   * @param {ArrayBuffer} bytes
   */
  put(bytes) {
    const [first, count, channels, perBin] = new Uint32Array(bytes, 0, 4);
    const values = new Float32Array(bytes, HEAD);
    if (this.rings.length !== channels || this.perBin !== perBin) {
      this.rings = Array.from({ length: channels }, () => new Float32Array(2 * this.size));
      this.count = 0;
    }
    if (first !== this.past) this.count = 0;
    this.perBin = perBin;
    for (let channel = 0; channel < channels; channel += 1) {
      const ring = this.rings[channel];
      for (let bin = 0; bin < count; bin += 1) {
        const to = 2 * ((first + bin) % this.size);
        const from = 2 * (channel * count + bin);
        ring[to] = values[from];
        ring[to + 1] = values[from + 1];
      }
    }
    this.past = first + count;
    this.count = Math.min(this.size, this.count + count);
    const least = this.past - Math.min(this.count, SPARE);
    if (this.place < least || this.place > this.past) this.place = this.past - Math.min(this.count, this.late());
  }

  /** Return the bins that are held back. */
  late() {
    return this.perBin ? (LATE * this.rate) / this.perBin : 0;
  }

  /** Return whether bins are left to be drawn. */
  waiting() {
    return this.shown < this.past;
  }

  /**
   * Go on by the time since the last call, a little faster or slower where bins came
   * late; return whether there is anything new to draw.
   * @param {number} now [ms]
   */
  play(now) {
    const since = Math.min((now - this.played) / 1000, FAR);
    this.played = now;
    const perSecond = this.perBin ? this.rate / this.perBin : 0;
    const behind = this.past - this.place;
    if (!perSecond || behind > FAR * perSecond) this.place = this.past - Math.min(behind, this.late());
    else this.place += Math.max(0, perSecond + PULL * (behind - since * perSecond / 2 - this.late())) * since;
    this.place = Math.min(this.place, this.past);
    const before = this.shown;
    this.shown = Math.floor(this.place);
    return this.shown !== before;
  }

  /** Return the number of the first bin that is drawn. */
  first() {
    return Math.max(0, this.shown - this.kept, this.past - this.count);
  }

  /**
   * Return the smallest and the largest value that are drawn of a channel.
   * @param {number} channel
   */
  reach(channel) {
    const ring = this.rings[channel];
    let low = Infinity;
    let high = -Infinity;
    for (let bin = this.first(); bin < this.shown; bin += 1) {
      const k = 2 * (bin % this.size);
      if (ring[k] < low) low = ring[k];
      if (ring[k + 1] > high) high = ring[k + 1];
    }
    return low <= high ? { low, high } : { low: 0, high: 0 };
  }

  /**
   * Return the largest value of the last half second, and whether it fills the range.
   * @param {number} channel
   */
  level(channel) {
    const bins = this.perBin ? Math.ceil((LEVEL * this.rate) / this.perBin) : 0;
    const ring = this.rings[channel];
    let largest = 0;
    for (let bin = Math.max(this.first(), this.shown - bins); ring && bin < this.shown; bin += 1) {
      const at = 2 * (bin % this.size);
      largest = Math.max(largest, -ring[at], ring[at + 1]);
    }
    const range = this.channels[channel]?.range ?? 0;
    const share = range ? largest / range : 0;
    return { largest, share, full: share >= NEAR_FULL };
  }
}
