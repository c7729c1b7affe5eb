// SPDX-License-Identifier: MIT
/** Verdicts by ear: one beep for a good hit, two low ones for a rejected hit. */

/** @type {AudioContext | null} */
let audio = null;

/** Allow sound; browsers want a key or a click first. */
export function allowSound() {
  audio ??= new AudioContext();
  if (audio.state === "suspended") void audio.resume();
}

/** Return whether sound may be heard. */
export function soundIsOn() {
  return audio !== null && audio.state === "running";
}

/** @type {string[]} what was played, for whoever asks */
export const played = [];

/** @param {"good" | "bad" | "trial"} verdict */
export function beep(verdict) {
  played.push(verdict);
  if (!audio || audio.state !== "running") return;
  const starts = verdict === "bad" ? [0, 0.22] : [0];
  const pitch = verdict === "bad" ? 330 : verdict === "good" ? 880 : 660;
  for (const start of starts) {
    const tone = audio.createOscillator();
    const gain = audio.createGain();
    const at = audio.currentTime + start;
    tone.frequency.value = pitch;
    gain.gain.setValueAtTime(0.0001, at);
    gain.gain.exponentialRampToValueAtTime(0.4, at + 0.01);
    gain.gain.exponentialRampToValueAtTime(0.0001, at + 0.16);
    tone.connect(gain).connect(audio.destination);
    tone.start(at);
    tone.stop(at + 0.18);
  }
}
