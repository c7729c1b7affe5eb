// SPDX-License-Identifier: MIT
/** What all screens of the desk share: which session, its title, undo, messages. */

import { announce, byId, el, fill, say, typesInField } from "./dom.js";
import { json, liveLink } from "./link.js";

/**
 * @typedef {object} Mode
 * @property {number} frequency_hz
 * @property {number} frequency_sd_hz
 * @property {number} damping_ratio
 * @property {number} damping_ratio_sd
 * @property {number | null} mpc
 * @property {number | null} misfit
 * @property {number} stable_orders
 * @property {boolean} by_hand
 * @property {boolean} pinned
 * @property {number} row
 */

/**
 * @typedef {object} Summary
 * @property {string} title
 * @property {boolean} simulated
 * @property {string[]} outputs
 * @property {string[]} inputs
 * @property {string} unit
 * @property {number} averages
 * @property {string} estimator
 * @property {number[]} band_hz
 * @property {string} results
 * @property {Mode[]} modes
 * @property {number} synthesis_error
 * @property {string[]} remarks
 * @property {{who: string, when: string, what: string}[]} log
 * @property {boolean} undo
 * @property {boolean} curves
 * @property {boolean} hits_known
 */

/**
 * @typedef {object} Desk
 * @property {number} number of the session, from 0
 * @property {Summary} summary as it is now
 * @property {(page: string) => Promise<any>} get
 * @property {(what: any) => Promise<boolean>} choose makes a choice; true where it was made
 * @property {(path: string, work: string) => Promise<any>} order has something done
 * @property {(text: string, bad?: boolean) => void} tell
 */

/**
 * Build a screen of the desk.
 * @param {string} title
 * @param {(desk: Desk, place: HTMLElement) => Promise<(() => void | Promise<void>)>} build
 *   fills the place once and returns what shows a changed state
 */
export async function deskScreen(title, build) {
  const main = byId("content");
  const message = el("p", { class: "desk-message", role: "status" });
  const place = el("div", { class: "desk-place" });
  try {
    const gone = el("p", { class: "trouble", role: "alert" },
      "No connection to the program: it has ended, or the computer slept. Choices are kept in the results.");
    gone.hidden = true;
    main.before(gone);
    liveLink("/desk/open", { open: (open) => { gone.hidden = open; } });
    const { titles, who } = await subjects(main);
    const asked = Number(new URLSearchParams(location.search).get("n") ?? 0);
    const number = Number.isInteger(asked) && asked >= 0 && asked < titles.length ? asked : 0;
    carryOn(number);
    fill(main, el("p", { class: "waiting" }, `Fitting poles of ${titles[number]}…`));
    const summary = /** @type {Summary} */ (await json(`/desk/${number}/summary`));
    /** @type {() => void | Promise<void>} */
    let show = () => {};
    const undo = el("button", { type: "button", click: () => desk.choose({ action: "undo" }) },
      "Undo ", el("kbd", {}, "U"));
    /** @type {Desk} */
    const desk = {
      number,
      summary,
      get: (page) => json(`/desk/${number}/${page}`),
      tell(text, bad = false) {
        message.className = bad ? "desk-message trouble" : "desk-message";
        say(message, text);
      },
      async choose(what) {
        desk.tell("Fitting…");
        const begun = performance.now();
        try {
          desk.summary = await json(`/desk/${number}/choose`, what);
        } catch (error) {
          desk.tell(/** @type {Error} */ (error).message, true);
          announce(/** @type {Error} */ (error).message);
          // Another desk may have chosen: show what is there.
          desk.summary = await json(`/desk/${number}/summary`);
          await refresh();
          return false;
        }
        const took = ((performance.now() - begun) / 1000).toFixed(2);
        const last = desk.summary.log.at(-1);
        desk.tell(`${last?.who} ${last?.what}. Fitted and written to ${desk.summary.results} in ${took} s.`);
        announce(`${last?.what}. ${desk.summary.modes.length} modes.`);
        await refresh();
        return true;
      },
      async order(path, work) {
        desk.tell(work);
        try {
          const answer = await json(`/desk/${number}/${path}`, {});
          desk.tell("");
          return answer;
        } catch (error) {
          desk.tell(/** @type {Error} */ (error).message, true);
          return null;
        }
      },
    };
    const refresh = async () => {
      undo.toggleAttribute("disabled", !desk.summary.undo);
      await show();
    };
    fill(main,
      el("div", { class: "desk-head" },
        el("h1", {}, title),
        undo),
      message, place);
    head(titles, number, desk.summary, who);
    show = await build(desk, place);
    await refresh();
    document.addEventListener("keydown", (event) => {
      if (typesInField(event)) return;
      if (event.key.toLowerCase() === "u" && desk.summary.undo) desk.choose({ action: "undo" });
    });
    // Another window may have chosen meanwhile.
    document.addEventListener("visibilitychange", async () => {
      if (document.hidden) return;
      desk.summary = await json(`/desk/${number}/summary`);
      await refresh();
    });
  } catch (error) {
    fill(main, el("p", { class: "trouble", role: "alert" }, /** @type {Error} */ (error).message));
  }
}

/**
 * Return what lies on the desk; a session that is still measured is waited for.
 * @param {Element} main
 * @returns {Promise<{titles: string[], who: string}>}
 */
async function subjects(main) {
  for (;;) {
    const found = await json("/desk/subjects");
    if (found.titles.length) return found;
    const words = el("p", { class: "waiting", role: "status" }, found.waiting);
    if (main.textContent !== found.waiting) fill(main, words);
    await new Promise((done) => { setTimeout(done, 1000); });
  }
}

/**
 * Have the links of the navigation keep the session.
 * @param {number} number
 */
function carryOn(number) {
  if (number === 0) return;
  for (const link of document.querySelectorAll("nav a")) {
    link.setAttribute("href", `${link.getAttribute("href")}?n=${number}`);
  }
}

/**
 * @param {string[]} titles
 * @param {number} number
 * @param {Summary} summary
 * @param {string} who
 */
function head(titles, number, summary, who) {
  const choice = titles.length < 2
    ? el("span", { class: "desk-title" }, titles[0])
    : el("select", {
      "aria-label": "Session",
      change: (/** @type {any} */ event) => {
        location.search = `?n=${event.target.value}`;
      },
    }, ...titles.map((one, i) => el("option", { value: i, selected: i === number }, one)));
  fill(byId("status"), summary.simulated && el("span", { class: "badge" }, "SIMULATED"), choice,
    el("span", {}, `choices by ${who}`));
}
