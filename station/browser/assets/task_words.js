// SPDX-License-Identifier: MIT
/** What the operator does next, and the verdict on the last hit, in few words. */

import { shown } from "./numbers.js";

/**
 * Return the task in large letters and in words, and its tone.
 * @param {any} state
 * @returns {{letters: string, words: string, tone: string}}
 */
export function task(state) {
  if (state.ended) {
    const how = state.ended.interrupted ? "interrupted" : "all is recorded";
    return { letters: "END", words: `The recording has ended: ${how}${state.ended.reason ? `, ${state.ended.reason}` : ""}.`, tone: "calm" };
  }
  if (state.open_loops) {
    return { letters: "CABLE", words: `Sensor loop open: ${state.open_loops}. Hits wait for the cable.`, tone: "alarm" };
  }
  if (state.paused) return { letters: "PAUSE", words: "Hits are ignored; space continues.", tone: "hold" };
  if (state.tighten) {
    const bolt = state.tighten;
    return { letters: `BOLT ${bolt.bolt} · ${shown(bolt.target)} N m`, words: `Tighten bolt ${bolt.bolt} of ${bolt.bolts} to ${shown(bolt.target)} N m.`, tone: "hold" };
  }
  if (!state.begun) return { letters: "START", words: "The instrument is being opened.", tone: "calm" };
  if (!state.asked) return { letters: "WAIT", words: "Keep the hammer still: its noise is measured.", tone: "hold" };
  return strike(state);
}

/** @param {any} state */
function strike(state) {
  const now = state.conditions.find((/** @type {any} */ c) => c.mark === "now");
  const tone = state.trial ? "trial" : "go";
  if (!now) return { letters: "HIT", words: `Hit ${state.asked}.`, tone };
  const direction = state.begun?.direction ?? "";
  const torque = now.torque === null ? "" : ` · ${shown(now.torque)} N m`;
  let words = `${state.trial ? "Trial hit: strike" : "Strike"} point ${now.point}`;
  if (direction) words += ` in ${direction}`;
  if (now.torque !== null) words += `, bolts at ${shown(now.torque)} N m`;
  if (now.level !== null) words += `, peak ${shown(now.level)} N`;
  return { letters: `HIT ${now.point} ${direction}${torque}`, words: `${words}.`, tone };
}

/**
 * Return the verdict on the last hit.
 * @param {any} state
 * @returns {{title: string, reason: string, tone: string, hit: number | null}}
 */
export function verdict(state) {
  const last = state.hits[state.hits.length - 1];
  if (!last) return { title: "No hit yet", reason: "", tone: "none", hit: null };
  const tone = last.verdict === "ok" ? "good" : last.word === "trial" ? "trial" : "bad";
  const average = state.average;
  const count = average && average.hit === last.number ? `  ${average.good}/${average.wanted}` : "";
  const word = last.verdict === "ok" ? "ACCEPTED" : last.word.toUpperCase();
  return {
    title: `HIT ${last.number + 1}  ${word}${count}`,
    reason: `${shown(last.peak)} N at ${last.point}; ${last.reason}`,
    tone,
    hit: last.number,
  };
}
