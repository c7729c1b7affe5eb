// SPDX-License-Identifier: MIT
/** The screen Report: writes the HTML report with the modes as chosen. */

import { deskScreen } from "./desk_frame.js";
import { el, fill } from "./dom.js";
import { shown } from "./numbers.js";

deskScreen("Report", async (desk, place) => {
  const answer = el("p", { role: "status" });
  const open = el("a", { href: `/desk/${desk.number}/report.html`, target: "_blank", rel: "noopener", hidden: true }, "Open it");
  const write = el("button", {
    type: "button", class: "first",
    click: async () => {
      write.setAttribute("disabled", "");
      const made = await desk.order("write-report", "Writing the report…");
      write.removeAttribute("disabled");
      if (!made) return;
      fill(answer, "Written: ", el("code", {}, made.name), " in ", el("code", {}, made.folder));
      open.hidden = false;
    },
  }, "Write the report");
  const facts = el("ul");
  fill(place, el("section", { class: "panel" },
    el("p", {}, "One HTML file that opens without a network: hits, FRFs, poles, modes, shapes, and who chose what."),
    facts, el("div", { class: "row" }, write, open), answer));
  return () => {
    const { modes, log, results } = desk.summary;
    const hand = modes.filter((one) => one.by_hand).length;
    fill(facts,
      el("li", {}, `${modes.length} modes, ${hand} of them chosen by hand`
        + `${modes.length ? `, ${shown(modes[0].frequency_hz)} to ${shown(modes[modes.length - 1].frequency_hz)} Hz` : ""}`),
      el("li", {}, log.length ? `${log.length} choices, kept in ${results}` : "no choice was made: the modes are those of the automatic selection"));
  };
});
