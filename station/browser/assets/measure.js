// SPDX-License-Identifier: MIT
/** Measure: what to do, what became of the last hit, and what it was good for. */

import { answersIn, followSession } from "./bench_link.js";
import { curvePlot } from "./curves.js";
import { announce, byId, el, fill, say } from "./dom.js";
import { HitPlots } from "./hit_plots.js";
import { json } from "./link.js";
import { clock, shown } from "./numbers.js";
import { actionBar, sessionActions } from "./operator_keys.js";
import { pointTable } from "./point_table.js";
import { allowSound, beep, soundIsOn } from "./sounds.js";
import { task, verdict } from "./task_words.js";

/** @type {any} */
let state = null;
let channel = 0;
let struck = -1;
let judged = "";
let averaged = "none";

const warnings = el("section", { "aria-label": "Warnings", "aria-live": "assertive" });
const letters = el("p", { class: "letters", id: "task" });
const words = el("p", { class: "task-words", id: "task-words" });
const order = el("section", { class: "order", "aria-label": "What to do" }, letters, words);
const verdictTitle = el("p", { class: "verdict-title", id: "verdict" });
const verdictReason = el("p", { class: "verdict-reason", id: "reason" });
const band = el("section", { class: "band none", "aria-label": "Verdict on the last hit" }, verdictTitle, verdictReason);
const bought = el("section", { class: "bought", "aria-label": "What the last hit bought" });
const counts = el("dl", { class: "counts" });
const bar = el("progress", { max: 1, value: 0, "aria-label": "Good hits of the plan" });
const answer = el("p", { class: "answer", "aria-live": "polite", id: "answer" });
const points = el("section", { class: "panel", "aria-label": "Points" });
const channels = el("div", { class: "row", role: "group", "aria-label": "Channel that is drawn" });
const sound = el("button", { type: "button", class: "sound", click: allowSound }, "Sound on");
const scopeBox = el("section", { class: "panel across" }, el("h2", {}, "Signals"));

const main = byId("content");
main.classList.add("measure");
const bars = actionBar(sessionActions(() => state, turn));
const plots = new HitPlots();
fill(
  main, warnings, order, band, bought,
  el("section", { class: "panel progress", "aria-label": "Progress" }, counts, bar),
  bars, answer,
  el("div", { class: "row" }, channels, sound),
  el("div", { class: "grid" }, plots.pulseBox, plots.spectrumBox, plots.responseBox, plots.frfBox, plots.phaseBox, plots.coherenceBox, scopeBox),
  points,
);
plots.build(curvePlot);
answersIn(answer);

// Browsers allow sound after the first key or click only.
for (const kind of ["keydown", "pointerdown"]) addEventListener(kind, allowSound, { once: true });
setInterval(() => { sound.hidden = soundIsOn(); }, 500);

const scope = followSession(show);
scope.drawIn(scopeBox);

/** @param {any} fresh */
function show(fresh) {
  state = fresh;
  showTask();
  showVerdict();
  showWarnings();
  showProgress();
  showBought();
  showChannels();
  pointTable(points, state);
  // A state comes every second, for its clocks; curves change with an event or another channel.
  const curves = `${state.last} ${channelName()}`;
  if (curves !== averaged) plots.average(state, channelName());
  averaged = curves;
}

function showTask() {
  const now = task(state);
  say(letters, now.letters);
  if (state.ended) {
    if (!words.querySelector("a")) fill(words, `${now.words} `, el("a", { href: "/poles", id: "to-poles" }, "Choose poles"));
  } else say(words, now.words);
  order.className = `order ${now.tone}`;
}

function showVerdict() {
  const now = verdict(state);
  band.className = `band ${now.tone}`;
  say(verdictTitle, now.title);
  say(verdictReason, now.reason);
  if (now.hit === null) return;
  const mark = `${now.hit} ${now.title}`;
  if (struck === -1) struck = now.hit; // what is past makes no sound
  else if (now.hit > struck || (now.hit === struck && mark !== judged)) {
    if (now.hit > struck) beep(now.tone === "good" ? "good" : now.tone === "trial" ? "trial" : "bad");
    announce(`${now.title}. ${now.reason}`);
    struck = now.hit;
  }
  if (mark !== judged) void picture(now.hit);
  judged = mark;
}

/** @param {number} hit */
async function picture(hit) {
  try {
    plots.add(await json(`/bench/hit/${hit}`), state, channelName());
  } catch {
    // Of a session that is over only the averages are at hand.
  }
}

function showWarnings() {
  if (warnings.childElementCount === state.warnings.length + (state.warnings.length ? 1 : 0)) return;
  fill(
    warnings,
    ...state.warnings.map((/** @type {string} */ line) => el("p", { class: "warning" }, line)),
    state.warnings.length ? el("p", { class: "note" }, "Warnings stay until they are seen: ", el("kbd", {}, "w")) : null,
  );
}

function showProgress() {
  const here = state.conditions.find((/** @type {any} */ c) => c.mark === "now");
  const good = state.conditions.reduce((/** @type {number} */ n, /** @type {any} */ c) => n + Math.min(c.good, c.wanted), 0);
  const wanted = state.conditions.reduce((/** @type {number} */ n, /** @type {any} */ c) => n + c.wanted, 0);
  const left = state.conditions.reduce((/** @type {number} */ n, /** @type {any} */ c) => n + c.left, 0);
  const whole = state.conditions.filter((/** @type {any} */ c) => c.left === 0).length;
  bar.setAttribute("value", String(wanted ? good / wanted : 0));
  const elapsed = state.first_time === null ? 0 : state.now - state.first_time;
  const rows = [
    ["here", here ? `${here.good} of ${here.wanted}` : "–"],
    ["hits left", left],
    ["points done", `${whole} of ${state.planned}`],
    ["elapsed", clock(elapsed)],
    ["time left", state.ended ? "–" : state.seconds_left === null ? "after the first hit" : `about ${clock(state.seconds_left)}`],
    ["rejected", state.struck - (state.verdicts.ok ?? 0) - trials()],
    ...(state.lost ? [["samples lost", state.lost]] : []),
  ];
  fill(counts, ...rows.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, value))));
}

function trials() {
  return state.hits.filter((/** @type {any} */ hit) => hit.word === "trial").length;
}

function showBought() {
  const gain = state.gain;
  const hit = state.average?.hit;
  const last = state.hits[state.hits.length - 1];
  bought.hidden = !gain || gain.hit !== hit || last?.verdict !== "ok";
  if (bought.hidden) return;
  const half = (/** @type {number} */ value) => plain(value);
  const percent = (/** @type {number} */ value) => `${plain(100 * value)} %`;
  fill(
    bought,
    el("h2", {}, `What hit ${gain.hit + 1} bought, and what ${gain.more} more would`),
    el("div", { class: "scroll" }, el("table", {},
      el("thead", {}, el("tr", {},
        ...["resonance", "sd of frequency", `with ${gain.more} more`, "sd of damping", `with ${gain.more} more`]
          .map((name) => el("th", { scope: "col" }, name)))),
      el("tbody", {}, ...gain.peaks.slice(0, 4).map((/** @type {any} */ peak) => el("tr", {},
        el("td", {}, `${shown(peak.frequency, 5)} Hz`),
        el("td", {}, `${fell(peak.frequency_sd_before, peak.frequency_sd, (v) => `${half(v)} Hz`)}`),
        el("td", {}, `${half(peak.frequency_sd_after)} Hz`),
        el("td", {}, `${fell(peak.damping_sd_before, peak.damping_sd, percent)}`),
        el("td", {}, percent(peak.damping_sd_after)),
      ))))),
  );
}

/**
 * @param {number | null} before
 * @param {number} now
 * @param {(value: number) => string} name
 */
function fell(before, now, name) {
  return before === null ? name(now) : `${name(before)} → ${name(now)}`;
}

/** @param {number} value an uncertainty, two digits */
function plain(value) {
  return value > 0 && value < 0.1 ? value.toFixed(Math.min(7, 1 - Math.floor(Math.log10(value)))) : shown(value, 2);
}

function responses() {
  return state.channels.filter((/** @type {any} */ c) => c.quantity !== "force").map((/** @type {any} */ c) => c.name);
}

function channelName() {
  const names = responses();
  return names.length ? names[((channel % names.length) + names.length) % names.length] : "";
}

function showChannels() {
  const names = responses();
  if (channels.childElementCount !== names.length) {
    fill(channels, ...names.map((/** @type {string} */ name, /** @type {number} */ i) =>
      el("button", { type: "button", click: () => turn(i - channel) }, name)));
  }
  for (const button of channels.children) {
    button.setAttribute("aria-pressed", String(button.textContent === channelName()));
  }
}

/** @param {number} step */
function turn(step) {
  channel += step;
  if (!state) return;
  showChannels();
  plots.average(state, channelName());
  plots.redraw(channelName());
}
