// SPDX-License-Identifier: MIT
/** The screen FRFs: the matrix, one FRF with coherence, and the hits it is made of. */

import { deskScreen } from "./desk_frame.js";
import { el, fill } from "./dom.js";
import { frfPlots, pairChoice } from "./frf_plots.js";
import { shown } from "./numbers.js";

const MOST_CELLS = 240;
const HIT_HEADS = ["", "", "wide-only", "", "words", ""];
const ESTIMATORS = /** @type {const} */ ([
  ["H1", "biased low by noise in the force"],
  ["H2", "biased high by noise in the response"],
  ["Hv", "between the two"],
]);

deskScreen("FRFs", async (desk, place) => {
  const plots = el("div");
  const picture = frfPlots(plots, { number: desk.number, unit: desk.summary.unit });
  const pair = pairChoice(desk.summary, (output, input) => choose(output, input));
  const matrix = el("div", { class: "scroll" });
  const hits = el("div", { class: "scroll" });
  const estimators = el("div", { class: "row", role: "group", "aria-label": "Estimator" });
  const facts = el("p", { class: "note" });
  const hitsPanel = el("section", { class: "panel", "aria-label": "Hits" },
    el("h2", {}, "Hits"), el("p", { class: "note" }, "Dropping a hit computes FRFs and poles again."), hits);
  /** @type {HTMLElement[][]} */
  let cells = [];
  const choose = (/** @type {number} */ output, /** @type {number} */ input) => {
    pair.set(output, input);
    cells.flat().forEach((cell) => cell.setAttribute("aria-pressed", "false"));
    cells[output]?.[input]?.setAttribute("aria-pressed", "true");
    return picture.show(output, input);
  };
  fill(place,
    el("div", { class: "desk-grid" },
      el("section", { class: "panel", "aria-label": "FRF" },
        el("div", { class: "row between" }, pair.row, estimators), facts, plots),
      el("section", { class: "panel", "aria-label": "FRF matrix" }, el("h2", {}, "All FRFs"), matrix)),
    desk.summary.hits_known && hitsPanel);

  const showMatrix = async () => {
    const page = await desk.get("matrix");
    if (page.outputs.length * page.inputs.length > MOST_CELLS) {
      fill(matrix, el("p", { class: "note" }, `${page.outputs.length} responses and ${page.inputs.length} forces: select above.`));
      return;
    }
    cells = page.misfit.map((/** @type {number[]} */ row, /** @type {number} */ output) => row.map((missed, input) => {
      const coherence = page.coherence?.[output]?.[input];
      const words = `${shown(100 * missed, 2)} %${coherence === undefined ? "" : `, γ² ${shown(coherence, 3)}`}`;
      return el("button", {
        type: "button", class: "cell", "aria-pressed": "false",
        "aria-label": `Response ${page.outputs[output]}, force at ${page.inputs[input]}: missed ${words}`,
        click: () => choose(output, input),
      }, words);
    }));
    fill(matrix, el("table", { class: "matrix" },
      el("caption", {}, `Share of each FRF that the modes miss${page.coherence ? ", and its mean coherence γ²" : ""}.`),
      el("thead", {}, el("tr", {}, el("th", { class: "words" }, "response"),
        ...page.inputs.map((/** @type {string} */ one) => el("th", {}, `force at ${one}`)))),
      el("tbody", {}, ...cells.map((row, output) => el("tr", {},
        el("th", { class: "words", scope: "row" }, page.outputs[output] || String(output + 1)),
        ...row.map((cell) => el("td", {}, cell)))))));
  };
  const showHits = async () => {
    if (!desk.summary.hits_known) return;
    const found = await desk.get("hits");
    fill(hits, el("table", {},
      el("thead", {}, el("tr", {}, ...["#", "point", "time [s]", "peak [N]", "verdict", ""].map((one, i) => (
        el("th", { class: HIT_HEADS[i] }, one))))),
      el("tbody", {}, ...found.map((/** @type {any} */ hit, /** @type {number} */ i) => {
        const good = hit.verdict === "ok";
        return el("tr", { class: good ? "" : "out" },
          el("td", {}, i + 1), el("td", {}, hit.point), el("td", { class: "wide-only" }, shown(hit.time_s, 5)),
          el("td", {}, shown(hit.peak_n, 4)),
          el("td", { class: "words reason" }, `${good ? "accepted" : hit.verdict}: ${hit.reason}`),
          el("td", {}, el("button", {
            type: "button", class: "small", "aria-label": `${good ? "Drop" : "Keep"} hit ${i + 1}`,
            click: () => desk.choose({
              action: good ? "drop_hit" : "keep_hit", name: hit.recording, time: hit.time_s,
            }),
          }, good ? "Drop" : "Keep")));
      }))));
  };
  return async () => {
    const { summary } = desk;
    fill(estimators, ...(summary.hits_known ? ESTIMATORS.map(([name, words]) => el("button", {
      type: "button", title: words, "aria-pressed": String(name === summary.estimator),
      click: () => name !== desk.summary.estimator && desk.choose({ action: "estimator", name }),
    }, name)) : []));
    fill(facts, summary.averages ? `${summary.averages} averages. ` : "",
      `Band of the fit: ${shown(summary.band_hz[0])} to ${shown(summary.band_hz[1])} Hz.`);
    await showMatrix();
    await showHits();
    await choose(...pair.now());
  };
});
