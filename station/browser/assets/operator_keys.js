// SPDX-License-Identifier: MIT
/** Keys, buttons and typed arguments of an operator; all of them make commands. */

import { command } from "./bench_link.js";
import { el, fill, typesInField } from "./dom.js";

/**
 * @typedef {object} Action
 * @property {string} key as `KeyboardEvent.key`
 * @property {string} [cap] what the key is called
 * @property {string} name on the button
 * @property {() => void} run
 * @property {boolean} [first] whether it is used most
 */

const dialog = /** @type {HTMLDialogElement} */ (el("dialog", { class: "ask" }));

/**
 * Ask for a line of text.
 * @param {string} question
 * @param {{numeric?: boolean, button: string}} given
 * @returns {Promise<string | null>} null where the question was left
 */
export function askFor(question, given) {
  return new Promise((resolve) => {
    const input = /** @type {HTMLInputElement} */ (
      el("input", { id: "asked", autocomplete: "off", maxlength: 400, inputmode: given.numeric ? "numeric" : "text" })
    );
    const form = el("form", { method: "dialog", submit: (/** @type {Event} */ event) => {
      event.preventDefault();
      dialog.close(input.value.trim());
    } },
      el("label", { for: "asked" }, question), input,
      el("div", { class: "row" },
        el("button", { class: "first", type: "submit" }, given.button),
        el("button", { type: "button", click: () => dialog.close("") }, "Cancel ", el("kbd", {}, "Esc"))),
    );
    show(form, () => resolve(dialog.returnValue || null));
    input.focus();
  });
}

/**
 * Ask for yes or no.
 * @param {string} question
 * @param {string} button
 * @returns {Promise<boolean>}
 */
export function confirmed(question, button) {
  return new Promise((resolve) => {
    const form = el("form", { method: "dialog" },
      el("p", {}, question),
      el("div", { class: "row" },
        el("button", { class: "first", value: "yes" }, button, " ", el("kbd", {}, "y")),
        el("button", { value: "no" }, "No ", el("kbd", {}, "n"))));
    const choose = (/** @type {KeyboardEvent} */ event) => {
      if (event.key === "y") dialog.close("yes");
      else if (event.key === "n") dialog.close("no");
      else return;
      event.preventDefault();
    };
    dialog.addEventListener("keydown", choose);
    show(form, () => {
      dialog.removeEventListener("keydown", choose);
      resolve(dialog.returnValue === "yes");
    });
  });
}

/**
 * @param {HTMLElement} content
 * @param {() => void} closed
 */
function show(content, closed) {
  if (dialog.open) return;
  if (!dialog.isConnected) document.body.append(dialog);
  fill(dialog, content);
  dialog.returnValue = "";
  dialog.addEventListener("close", closed, { once: true });
  dialog.showModal();
}

/**
 * Build the buttons of actions, and let their keys do the same.
 * @param {Action[]} actions
 * @returns {HTMLElement}
 */
export function actionBar(actions) {
  document.addEventListener("keydown", (event) => {
    if (typesInField(event) || dialog.open || event.repeat) return;
    const action = actions.find((one) => one.key === event.key);
    if (!action) return;
    event.preventDefault();
    action.run();
  });
  return el("div", { class: "actions", role: "group", "aria-label": "What the operator can do" },
    ...actions.map((action) => el(
      "button",
      {
        type: "button", class: action.first ? "first" : null, "aria-keyshortcuts": action.key,
        click: (/** @type {MouseEvent} */ event) => {
          action.run();
          // The space bar pauses; it must not press this button again.
          if (event.detail > 0 && event.currentTarget instanceof HTMLElement) event.currentTarget.blur();
        },
      },
      action.name, " ", el("kbd", {}, action.cap ?? action.key),
    )));
}

/**
 * Return the actions of a session.
 * @param {() => any} state of the session now
 * @param {(step: number) => void} turn to another channel
 * @returns {Action[]}
 */
export function sessionActions(state, turn) {
  const send = (/** @type {Record<string, unknown>} */ given) => void command(given);
  return [
    { key: "a", name: "Accept", run: () => send({ command: "accept" }) },
    { key: "r", name: "Reject", run: () => send({ command: "reject" }) },
    { key: "u", name: "Undo", run: () => send({ command: "undo" }) },
    { key: "h", name: "Reject number", run: async () => {
      const number = await askFor("Number of the hit to reject", { numeric: true, button: "Reject" });
      if (number !== null) send({ command: "reject", hit: Number.parseInt(number, 10) || 0 });
    } },
    { key: "p", name: "Repeat point", run: () => send({ command: "repeat" }) },
    { key: "n", name: "Next point", run: () => send({ command: "next" }) },
    { key: "g", name: "Go to point", run: async () => {
      const points = [...new Set((state()?.conditions ?? []).map((/** @type {any} */ c) => c.point))];
      const point = await askFor(`Point to go to (${points.join(", ")})`, { button: "Go" });
      if (point !== null) send({ command: "go", point });
    } },
    { key: "t", name: "Note", run: async () => {
      const text = await askFor("Note, stored in the session", { button: "Store" });
      if (text !== null) send({ command: "note", text });
    } },
    { key: " ", cap: "space", name: "Pause", run: () => send({ command: state()?.paused ? "continue" : "pause" }) },
    { key: "w", name: "Warnings seen", run: () => send({ command: "seen" }) },
    { key: "c", name: "Next channel", run: () => turn(1) },
    { key: "q", name: "Quit", run: async () => {
      const now = state();
      const left = (now?.planned ?? 0) - (now?.done ?? 0);
      if (await confirmed(`End the session? ${left} of ${now?.planned ?? 0} conditions are open.`, "End")) {
        send({ command: "quit", confirmed: true });
      }
    } },
  ];
}
