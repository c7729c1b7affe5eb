// SPDX-License-Identifier: MIT
/** Elements of a page. Text from files is a text node, never markup. */

/** @typedef {Node | string | number | null | undefined | false} Child */

/**
 * Make an element.
 * @param {string} tag
 * @param {Record<string, string | number | boolean | null | undefined | ((event: any) => void)>} [given]
 *   attributes; a function is a listener of the event of that name; `null` and `false`
 *   leave an attribute out
 * @param {...Child} children
 * @returns {HTMLElement}
 */
export function el(tag, given = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(given)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) {
      made.setAttribute(name, String(value));
    }
  }
  fill(made, ...children);
  return made;
}

/**
 * Replace the content of an element.
 * @param {Element} parent
 * @param {...Child} children
 */
export function fill(parent, ...children) {
  parent.replaceChildren(
    ...children
      .filter((one) => one !== null && one !== undefined && one !== false)
      .map((one) => (one instanceof Node ? one : document.createTextNode(String(one)))),
  );
}

/**
 * Set the text of an element where it differs, so that nothing is announced twice.
 * @param {Element} element
 * @param {string} text
 */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * Return the parts of a name, which a line may end between.
 * @param {string} name for example "session:bolted.normal_stiffness"
 * @returns {Child[]}
 */
export function breakable(name) {
  return name.split(/(?<=[:._])/).flatMap((part) => [part, el("wbr")]);
}

/**
 * Return an element that must be there.
 * @param {string} id
 * @returns {HTMLElement}
 */
export function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`no element '${id}'`);
  return found;
}

/**
 * Have a screen reader speak.
 * @param {string} text
 */
export function announce(text) {
  say(byId("spoken"), text);
}

/**
 * Return whether a key that was pressed belongs to a field rather than to the page.
 * @param {KeyboardEvent} event
 */
export function typesInField(event) {
  const at = event.target;
  return (
    event.ctrlKey || event.metaKey || event.altKey ||
    (at instanceof HTMLElement && at.matches("input, select, textarea, dialog *"))
  );
}
