// SPDX-License-Identifier: MIT
/** Colours of the palette for canvases, which style sheets do not reach. */

const dark = window.matchMedia("(prefers-color-scheme: dark)");
/** @type {Map<string, string>} */
const known = new Map();
dark.addEventListener("change", () => known.clear());

/**
 * Return a colour of palette.css.
 * @param {string} name without its dashes, `"curve-1"`
 */
export function colour(name) {
  let found = known.get(name);
  if (found === undefined) {
    found = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    known.set(name, found);
  }
  return found;
}

/**
 * Return the colour of a curve by its number, from 0.
 * @param {number} number
 */
export function curveColour(number) {
  return colour(`curve-${(number % 6) + 1}`);
}

/**
 * Call again whenever light becomes dark or the other way round.
 * @param {() => void} draw
 */
export function onTheme(draw) {
  dark.addEventListener("change", draw);
}
