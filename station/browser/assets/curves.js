// SPDX-License-Identifier: MIT
/** Curves with numbered axes, by uPlot, in the colours of the palette. */

import uPlot from "./vendor/uPlot.esm.js";
import { colour, onTheme } from "./theme.js";

/**
 * @typedef {object} Curve
 * @property {string} name
 * @property {string} colour of the palette, `"curve-1"`
 * @property {number} [width]
 * @property {boolean} [dashed]
 *
 * @typedef {object} CurvePlot
 * @property {(data: (number | null)[][], curves?: Curve[]) => void} show
 *   the abscissa first, then one row a curve
 * @property {() => uPlot} plot as it is now
 */

const FONT = "13px system-ui, sans-serif";
const TITLE = "600 13px system-ui, sans-serif";

/**
 * Return the numbers of an axis without separators, as everywhere else.
 * @param {unknown} _
 * @param {(number | null)[]} ticks
 */
const plain = (_, ticks) => ticks.map((tick) => (tick === null ? "" : String(Number(tick.toPrecision(10)))));

/**
 * Make a plot in an element; it follows the width of the element.
 * @param {HTMLElement} parent
 * @param {{
 *   x: string, y: string, curves: Curve[], height?: number, label: string,
 *   xLog?: boolean, xRoom?: number, yRange?: [number, number], hooks?: any,
 * }} given names of the axes with units; `label` is read by screen readers; `xRoom` is
 *   room on the right, over the width of the data
 * @returns {CurvePlot}
 */
export function curvePlot(parent, given) {
  let curves = given.curves;
  /** @type {any} */
  let data = [[], ...curves.map(() => [])];
  /** @type {any} */
  let plot;
  parent.setAttribute("role", "img");
  parent.setAttribute("aria-label", given.label);

  const axis = (/** @type {string} */ label) => ({
    label, font: FONT, labelFont: TITLE, labelSize: 20, size: 56, values: plain,
    stroke: () => colour("soft"),
    grid: { stroke: () => colour("grid"), width: 1 },
    ticks: { stroke: () => colour("line"), width: 1, size: 5 },
  });
  const make = () => {
    plot?.destroy();
    plot = new uPlot({
      width: Math.max(200, parent.clientWidth),
      height: given.height ?? 220,
      legend: { show: false },
      cursor: { y: false, points: { show: false } },
      scales: {
        x: {
          time: false,
          ...(given.xLog ? { distr: 3 } : {}),
          ...(given.xRoom ? { range: (/** @type {any} */ _, /** @type {number} */ low, /** @type {number} */ high) =>
            [low, high + (high - low) * (given.xRoom ?? 0)] } : {}),
        },
        y: given.yRange ? { range: given.yRange } : {},
      },
      axes: [{ ...axis(given.x), size: 34 }, axis(given.y)],
      hooks: given.hooks ?? {},
      series: [{}, ...curves.map((curve) => ({
        label: curve.name,
        stroke: () => colour(curve.colour),
        width: curve.width ?? 1.5,
        dash: curve.dashed ? [6, 4] : undefined,
        points: { show: false },
      }))],
    }, data, parent);
  };
  make();
  new ResizeObserver(() => {
    const width = Math.max(200, parent.clientWidth);
    if (width !== plot.width) plot.setSize({ width, height: given.height ?? 220 });
  }).observe(parent);
  onTheme(() => plot.redraw());
  return {
    show(fresh, wanted) {
      data = fresh;
      if (wanted && wanted.length !== curves.length) {
        curves = wanted;
        make();
      } else {
        if (wanted) curves = wanted;
        plot.setData(data);
      }
    },
    plot: () => plot,
  };
}
