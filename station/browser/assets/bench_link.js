// SPDX-License-Identifier: MIT
/** What every screen of a running session shares: its state, badge, disk, commands. */

import { announce, byId, el, fill } from "./dom.js";
import { json, liveLink } from "./link.js";
import { room } from "./numbers.js";
import { Scope } from "./scope.js";

/** @typedef {any} State as bench_state.py writes it */

const [banner, badge, operator, disk, file] = ["", "", "", "", ""].map(() => el("span"));

/**
 * Follow the session.
 * @param {(state: State) => void} show called with every new state
 * @returns {Scope} its signals
 */
export function followSession(show) {
  const scope = new Scope();
  badge.className = "badge";
  badge.hidden = true;
  fill(byId("status"), badge, operator, disk, file);
  banner.className = "trouble";
  banner.hidden = true;
  byId("content").before(banner);
  liveLink("/bench/live", {
    text: ({ state }) => {
      status(state);
      scope.know(state);
      show(state);
    },
    binary: (bytes) => scope.take(bytes),
    open: (open) => {
      banner.hidden = open;
      banner.textContent = open ? "" :
        "No connection to the screen's server. The measurement continues; this page connects again by itself.";
    },
  });
  return scope;
}

/** @param {State} state */
function status(state) {
  badge.hidden = !state.begun?.simulated;
  badge.textContent = "SIMULATED";
  operator.textContent = state.begun?.operator ? `operator ${state.begun.operator}` : "";
  disk.textContent = state.free === null ? "" : `disk ${room(state.free)} free`;
  file.textContent = String(state.file).split("/").pop() ?? "";
  file.title = state.file;
}

/** @type {HTMLElement | null} */
let answerLine = null;

/**
 * Give the element that shows answers to commands.
 * @param {HTMLElement} element
 */
export function answersIn(element) {
  answerLine = element;
}

/**
 * Submit a command; its answer is shown and spoken.
 * @param {Record<string, unknown>} command
 * @returns {Promise<boolean>} whether it was done
 */
export async function command(command) {
  let words = "";
  let done = false;
  try {
    const answer = await json("/bench/command", command);
    done = answer.done === true;
    words = done ? answer.words : `not done: ${answer.words}`;
  } catch (error) {
    words = `not done: ${error instanceof Error ? error.message : error}`;
  }
  if (answerLine) {
    answerLine.textContent = words;
    answerLine.classList.toggle("refused", !done);
  }
  announce(words);
  return done;
}
