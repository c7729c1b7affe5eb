// SPDX-License-Identifier: MIT
/** Values with their standard deviation, both with one exponent and equal digits. */

import { shown } from "./numbers.js";

const LARGE = 1e5;
const SMALL = 1e-3;

/**
 * Return value and standard deviation as texts, to two digits of the latter.
 * @param {number} value
 * @param {number | null | undefined} sd
 * @returns {{value: string, sd: string, power: string}} `power` is "" or " e+7"
 */
export function uncertain(value, sd) {
  if (!Number.isFinite(value)) return { value: "–", sd: "", power: "" };
  const size = Math.abs(value);
  const exponent = size !== 0 && (size >= LARGE || size < SMALL) ? Math.floor(Math.log10(size)) : 0;
  const unit = 10 ** exponent;
  const power = exponent ? `e${exponent > 0 ? "+" : ""}${exponent}` : "";
  if (!sd || !Number.isFinite(sd) || sd <= 0) return { value: shown(value / unit, 6), sd: "", power };
  const digits = Math.min(8, Math.max(0, 1 - Math.floor(Math.log10(sd / unit))));
  return { value: (value / unit).toFixed(digits), sd: (sd / unit).toFixed(digits), power };
}

/**
 * Return the same in one line.
 * @param {number} value
 * @param {number | null | undefined} sd
 */
export function withSd(value, sd) {
  const { value: number, sd: spread, power } = uncertain(value, sd);
  if (!spread) return number + power;
  return power ? `(${number} ± ${spread})${power}` : `${number} ± ${spread}`;
}
