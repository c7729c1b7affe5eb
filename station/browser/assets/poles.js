// SPDX-License-Identifier: MIT
/** The screen Poles: choose, clear, merge, pin; live refit; curves over amplitude. */

import { amplitudePanel } from "./amplitude_curves.js";
import { deskScreen } from "./desk_frame.js";
import { announce, el, fill } from "./dom.js";
import { frfPlots, pairChoice } from "./frf_plots.js";
import { json } from "./link.js";
import { modeTable } from "./mode_table.js";
import { shown } from "./numbers.js";
import { MARK_WORDS, PoleChart } from "./pole_chart.js";

deskScreen("Poles", async (desk, place) => {
  const diagram = await desk.get("diagram");
  const chartPlace = el("div", { class: "plot" });
  const detail = el("p", { class: "pole-detail" });
  const poles = el("div", { class: "scroll" });
  const log = el("ol", { class: "log", reversed: true });
  const remarks = el("div");
  const plots = el("div");
  const picture = frfPlots(plots, { number: desk.number, unit: desk.summary.unit, small: true });
  const pair = pairChoice(desk.summary, (output, input) => picture.show(output, input));
  const quality = el("p", { class: "note" });
  const curves = amplitudePanel(desk);
  const hint = "Point at a pole, or use the arrow keys, to see what speaks for it.";

  const what = (/** @type {number} */ row) => ({
    frequency: diagram.frequency_hz[row],
    damping_ratio: diagram.damping_ratio[row],
    order: diagram.order[row],
  });
  /** @type {Map<number, any>} */
  const known = new Map();
  let looked = 0;
  const chart = new PoleChart(chartPlace, diagram, {
    choose: (row) => desk.choose({ action: "choose", ...what(row) }),
    pin: (row) => desk.choose({ action: "pin", ...what(row) }),
    clear: (low, high) => desk.choose({ action: "clear", frequency: low, second: high }),
    look: async (row) => {
      looked += 1;
      const own = looked;
      if (row === null) {
        fill(detail, hint);
        return;
      }
      const words = `${shown(diagram.frequency_hz[row], 7)} Hz, ${shown(100 * diagram.damping_ratio[row])} %, `
        + `order ${diagram.order[row]}, ${MARK_WORDS[diagram.stable[row]]}`;
      fill(detail, words);
      await new Promise((resolve) => setTimeout(resolve, 60));
      if (own !== looked) return;
      if (!known.has(row)) known.set(row, await json(`/desk/${desk.number}/pole/${row}`));
      if (own !== looked) return;
      const page = known.get(row);
      const more = `sd ${shown(page.frequency_sd_hz, 2)} Hz and ${shown(100 * page.damping_ratio_sd, 2)} %, `
        + `MPC ${shown(page.mpc, 3)}, stable at ${page.orders} orders`;
      fill(detail, words, el("br"), more);
      announce(`${words}; ${more}`);
    },
  });
  const sort = el("select", {
    "aria-label": "Curve behind the poles",
    change: (/** @type {any} */ event) => chart.indicate(event.target.value),
  }, el("option", { value: "mean" }, "mean |H|"), el("option", { value: "cmif" }, "CMIF"));
  const table = modeTable(desk, () => chart);
  fill(detail, hint);
  fill(place,
    el("div", { class: "desk-grid" },
      el("section", { class: "panel", "aria-label": "Stabilisation" },
        el("div", { class: "row between" }, el("h2", {}, "Stabilisation"),
          el("div", { class: "row" }, el("label", {}, "Behind ", sort),
            el("button", { type: "button", "aria-label": "Zoom in", click: () => chart.zoom(0.6) }, "+"),
            el("button", { type: "button", "aria-label": "Zoom out", click: () => chart.zoom(1 / 0.6) }, "−"),
            el("button", { type: "button", click: () => chart.show(chart.whole[0], chart.whole[1]) }, "All"))),
        chartPlace, detail, legend(), help()),
      el("section", { class: "panel", "aria-label": "Modes" },
        el("h2", {}, "Modes"), table.actions, poles, quality, remarks)),
    el("div", { class: "grid" },
      el("section", { class: "panel", "aria-label": "Synthesised and measured" },
        el("h2", {}, "Synthesised over measured"), pair.row, plots),
      curves.section),
    el("section", { class: "panel" }, el("h2", {}, "Choices"), log));

  return async () => {
    const { summary } = desk;
    chart.choose(summary.modes);
    fill(poles, table.show(summary.modes));
    fill(quality, `The synthesis misses ${shown(100 * summary.synthesis_error, 2)} % of the FRFs `
      + `(rms, ${shown(summary.band_hz[0])} to ${shown(summary.band_hz[1])} Hz).`);
    fill(remarks, ...summary.remarks.map((one) => el("p", { class: "note" }, one)));
    fill(log, ...(summary.log.length ? [...summary.log].reverse().map((one) => el("li", {},
      el("span", { class: "who" }, `${one.when.replace("T", " ").replace("+00:00", " UTC")} ${one.who}`),
      ` ${one.what}`)) : [el("li", { class: "note none" }, "None: the modes are those of the automatic selection.")]));
    curves.show();
    await picture.show(...pair.now());
  };
});

function legend() {
  const marks = ["dot", "ring", "triangle", "disc"];
  return el("ul", { class: "legend" }, ...MARK_WORDS.map((words, i) => el("li", {},
    el("span", { class: `mark ${marks[i]}`, "aria-hidden": "true" }), words)).reverse(),
  el("li", {}, el("span", { class: "mark line" }), "chosen by hand"),
  el("li", {}, el("span", { class: "mark line dashed" }), "chosen by the program"));
}

function help() {
  const key = (/** @type {string} */ name) => el("kbd", {}, name);
  return el("p", { class: "note" }, "Click chooses, drag clears, Shift with drag or the wheel zooms. Keys: ",
    key("←"), key("→"), " poles, ", key("↑"), key("↓"), " orders, ", key("Enter"), " choose, ", key("P"), " pin, ",
    key("Del"), " clear, ", key("+"), key("−"), key("0"), " zoom, ", key("U"), " undo.");
}
