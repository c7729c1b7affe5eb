// SPDX-License-Identifier: MIT
/** The screen Joint and gap: what was identified, what is missing, what to do next. */

import { deskScreen } from "./desk_frame.js";
import { breakable, el, fill } from "./dom.js";
import { shown } from "./numbers.js";
import { withSd } from "./uncertain.js";

/** @type {Record<string, string>} */
const VERDICTS = {
  none: "Nothing is missing",
  named: "A missing effect was named",
  ambiguous: "Several effects explain it equally well",
  mostly: "Most of what is missing was named",
  unknown: "Something is missing that no known effect explains",
};

deskScreen("Joint and gap", async (desk, place) => async () => {
  const found = await desk.get("findings");
  const joint = found.find((/** @type {any} */ one) => one.kind === "joint");
  const gap = found.find((/** @type {any} */ one) => one.kind === "gap");
  fill(place,
    el("div", { class: "grid" },
      el("section", { class: "panel", "aria-label": "Joint" }, el("h2", {}, "What was identified"),
        ...(joint ? jointPart(joint) : [missing("identify", "the joint of a model", desk.summary.title)])),
      el("section", { class: "panel", "aria-label": "Gap" }, el("h2", {}, "What is missing from the model"),
        ...(gap ? gapPart(gap) : [missing("gap", "what the model lacks", desk.summary.title)]))),
    others(found, [joint, gap]));
});

/**
 * @param {string} command
 * @param {string} what
 * @param {string} title
 */
function missing(command, what, title) {
  const session = title.split(" at ")[0].split(" and ")[0];
  const stem = session.replace(/\.[^.]*$/, "");
  const line = command === "identify"
    ? `jointbench identify model.toml ${session} --json ${stem}.identify.json`
    : `jointbench gap ${session} --model model.toml --json ${stem}.gap.json`;
  return el("div", {}, el("p", {}, `Nothing beside the session states ${what}. This command writes it:`),
    el("pre", {}, line), el("p", { class: "note" }, "Then load this page again."));
}

/** @param {any} found */
function source(found) {
  return el("p", { class: "note" }, `From ${found.source}`
    + `${found.own ? "" : ", which is not named like this session: check that it belongs to it"}.`);
}

/** @param {any} found */
function jointPart(found) {
  const { content } = found;
  const rows = Object.entries(content.parameters);
  return [
    el("p", { class: "verdict-line" }, `Joint: ${content.verdict}`),
    ...(content.reasons ?? []).map((/** @type {string} */ one) => el("p", { class: "note" }, one)),
    el("div", { class: "scroll" }, el("table", {},
      el("thead", {}, el("tr", {}, ...["parameter", "value", "95 % interval", "unit"].map((one, i) => (
        el("th", i ? {} : { class: "words" }, one))))),
      el("tbody", {}, ...rows.map(([name, one]) => {
        const value = /** @type {any} */ (one);
        return el("tr", {},
          el("td", { class: "words long-name" }, ...breakable(name)),
          el("td", {}, value.identifiable === false ? "not determined"
            : withSd(value.value, value.sd)),
          el("td", {}, (value.interval_95 ?? []).map((/** @type {any} */ end) => shown(end, 5)).join(" to ")),
          el("td", {}, value.unit));
      })))),
    modesPart(content.modes),
    source(found),
  ];
}

/** @param {any[] | undefined} modes */
function modesPart(modes) {
  if (!Array.isArray(modes) || !modes.length || modes[0].measured_hz === undefined) return null;
  return el("div", { class: "scroll" }, el("table", {},
    el("caption", {}, "Natural frequencies, measured and of the model with this joint."),
    el("thead", {}, el("tr", {}, ...["measured [Hz]", "model [Hz]", "difference [%]"].map((one) => el("th", {}, one)))),
    el("tbody", {}, ...modes.map((one) => el("tr", {},
      el("td", {}, shown(one.measured_hz, 6)), el("td", {}, shown(one.predicted_hz, 6)),
      el("td", {}, (100 * (one.predicted_hz / one.measured_hz - 1) || 0).toFixed(3).replace(/^-(0\.0+)$/, "$1")))))));
}

/** @param {any} found */
function gapPart(found) {
  const { content } = found;
  const effects = content.effects.map((/** @type {any} */ one) => el("li", {},
    el("strong", {}, String(one.name).replaceAll("_", " ")),
    one.site ? ` at ${one.site}` : "",
    `, confidence ${shown(100 * one.confidence, 3)} %`,
    el("ul", {}, ...Object.entries(one.parameters).map(([name, value]) => {
      const { value: number, sd, unit } = /** @type {any} */ (value);
      return el("li", {}, `${name} = ${withSd(number, sd)} ${unit}`);
    }))));
  return [
    el("p", { class: "verdict-line" }, VERDICTS[content.verdict] ?? String(content.verdict)),
    el("p", {}, String(content.reason ?? "")),
    effects.length ? el("ul", {}, ...effects) : null,
    beforeAfter(content),
    content.experiment ? el("p", {}, el("strong", {}, "Next experiment: "), String(content.experiment)) : null,
    source(found),
  ];
}

/** @param {any} content */
function beforeAfter(content) {
  const size = (/** @type {any} */ value) => (Number.isFinite(value) ? value : 0);
  const largest = Math.max(size(content.gap_before), size(content.gap_after), 1e-12);
  const bar = (/** @type {string} */ name, /** @type {number} */ value) => el("tr", {},
    el("th", { class: "words", scope: "row" }, name),
    el("td", { class: "words wide" }, el("meter", { min: 0, max: largest, value: size(value), "aria-label": `Gap ${name}` })),
    el("td", {}, shown(value, 3)));
  return el("table", { class: "gap-bars" },
    el("caption", {}, "Gap between model and measurement, on held-out records."),
    el("tbody", {}, bar("before", content.gap_before), bar("after", content.gap_after)));
}

/**
 * @param {any[]} found
 * @param {any[]} used
 */
function others(found, used) {
  const names = [...new Set(found.filter((one) => !used.includes(one)).map((one) => one.source))];
  return names.length ? el("p", { class: "note" }, `Not shown: ${names.join(", ")}.`) : null;
}
