// SPDX-License-Identifier: MIT
/** Setup: the session, its channels live, its points, and what trial hits proposed. */

import { answersIn, command, followSession } from "./bench_link.js";
import { byId, el, fill, say } from "./dom.js";
import { GeometryView } from "./geometry_view.js";
import { json } from "./link.js";
import { shown } from "./numbers.js";
import { pointTable } from "./point_table.js";
import { SettingPlots } from "./setting_plots.js";
import { verdict } from "./task_words.js";

/** @type {any} */
let state = null;
let pictured = -1;
let known = false;

const facts = el("dl", { class: "counts" });
const rows = el("tbody");
const points = el("div");
const places = new GeometryView();
const settings = new SettingPlots();
const answer = el("p", { class: "answer", "aria-live": "polite", id: "answer" });
const scopeBox = el("section", { class: "panel across" }, el("h2", {}, "Signals"));

fill(
  byId("content"),
  el("h1", {}, "Setup"),
  el("section", { class: "panel", "aria-label": "Session" }, facts),
  answer,
  el("div", { class: "grid wide" },
    el("section", { class: "panel across" }, el("h2", {}, "Channels"),
      el("div", { class: "scroll" }, el("table", { class: "lines" },
        el("thead", {}, el("tr", {}, ...["channel", "level", "range", "point", "sensor", "TEDS", "calibrated"]
          .map((name, i) => el("th", { scope: "col", class: i === 2 ? "" : "words" }, name)))),
        rows))),
    scopeBox),
  settings.box,
  el("div", { class: "grid wide" },
    el("section", { class: "panel" }, el("h2", {}, "Geometry"), places.canvas, places.note),
    el("section", { class: "panel" }, points)),
);
answersIn(answer);
settings.build((name, value) => void command({ command: "set", name, value }));
const scope = followSession(show);
scope.drawIn(scopeBox);
scope.listeners.push((words) => { if (words) showLevels(); });
void json("/bench/geometry").then((geometry) => places.know(geometry)).catch(() => undefined);

/** @param {any} fresh */
function show(fresh) {
  state = fresh;
  const begun = state.begun;
  const entries = begun ? [
    ["notes of the plan", state.notes_of_plan || "–"],
    ["operator", begun.operator || "–"],
    ["instrument", begun.source],
    ["rate", `${shown(begun.sample_rate / 1000)} kHz`],
    ["good hits a point", begun.repeats],
    ["points", new Set(state.conditions.map((/** @type {any} */ c) => c.point)).size],
    ["conditions", state.planned || state.conditions.length],
  ] : [["instrument", "is being opened"]];
  fill(facts, ...entries.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", { class: "words" }, value))));
  if (rows.childElementCount !== state.channels.length || Boolean(state.begun) !== known) channelRows();
  pointTable(points, state);
  places.show(state);
  settings.show(state);
  const hit = verdict(state).hit;
  if (hit !== null && hit !== pictured) {
    pictured = hit;
    void json(`/bench/hit/${hit}`).then((picture) => settings.picture(picture)).catch(() => undefined);
  }
  showLevels();
}

function channelRows() {
  known = Boolean(state.begun);
  fill(rows, ...state.channels.map((/** @type {any} */ channel) => {
    const sensor = state.sensors[channel.name] ?? {};
    const calibrated = sensor.calibrated ? `${sensor.calibrated}, due ${sensor.due}` : "–";
    return el("tr", {},
      el("td", {}, channel.name),
      el("td", { class: "words level" },
        el("meter", { min: 0, max: 1, high: 0.9, optimum: 0, value: 0, "aria-label": `Level of ${channel.name} over its range` }),
        el("span", { class: "state" })),
      el("td", {}, channel.range === null ? "–" : `${shown(channel.range)} ${channel.si}`),
      el("td", { class: "words" }, `${channel.point ?? ""} ${channel.direction ?? ""}`),
      el("td", { class: "words" }, `${channel.quantity}${sensor.serial ? `, no. ${sensor.serial}` : ""}`),
      tedsCell(channel.name),
      el("td", { class: "words" }, calibrated),
    );
  }));
}

/** @param {string} name of the channel */
function tedsCell(name) {
  const known = state.begun?.channels.find((/** @type {any} */ one) => one.name === name)?.teds ?? "";
  return el("td", { class: known.includes("another") ? "words alarm" : "words" }, known || "–");
}

function showLevels() {
  if (!state) return;
  const open = String(state.open_loops);
  [...rows.children].forEach((row, i) => {
    const level = scope.level(i);
    const name = state.channels[i].name;
    row.querySelector("meter")?.setAttribute("value", Math.min(1, level.share).toFixed(3));
    const cell = /** @type {HTMLElement} */ (row.querySelector(".state"));
    const loose = open.split(/[,;]\s*/).includes(name);
    say(cell, loose ? "OPEN CABLE" : level.full ? "OVERLOAD" : level.share < 1e-3 ? "< 0.1 %" : `${shown(100 * level.share, 2)} %`);
    cell.classList.toggle("alarm", loose || level.full);
  });
}
