// SPDX-License-Identifier: MIT
/** The points of the plan by torque and level, each with where it stands. */

import { el, fill } from "./dom.js";
import { shown } from "./numbers.js";

const SIGNS = { done: "✓", open: "·", incomplete: "!", now: "▶" };
/** @type {WeakMap<HTMLElement, string>} */
const drawn = new WeakMap();

/**
 * Draw the points where they changed.
 * @param {HTMLElement} parent
 * @param {any} state
 */
export function pointTable(parent, state) {
  const mark = JSON.stringify(state.conditions);
  if (drawn.get(parent) === mark) return;
  drawn.set(parent, mark);
  /** @type {Map<string, any[]>} */
  const rows = new Map();
  for (const one of state.conditions) {
    const torque = one.torque === null ? "" : `${shown(one.torque)} N m`;
    const level = one.level === null ? "" : `${shown(one.level)} N`;
    const name = [torque, level].filter(Boolean).join(", ") || "points";
    rows.set(name, [...(rows.get(name) ?? []), one]);
  }
  fill(
    parent,
    el("h2", {}, "Points"),
    ...[...rows].map(([name, list]) => el("div", { class: "points" },
      el("span", { class: "points-name" }, name),
      el("ul", {}, ...list.map((one) => el("li", { class: one.mark, title: one.name },
        el("b", {}, one.point), ` ${SIGNS[/** @type {keyof SIGNS} */ (one.mark)]}`,
        one.mark === "now" ? ` ${one.good}/${one.wanted}` : "",
        el("span", { class: "unseen" }, ` ${one.mark}`)))))),
    el("p", { class: "note" }, "✓ done   · open   ! incomplete   ▶ now"),
  );
}
