// SPDX-License-Identifier: MIT
/** Requests to the server of this screen, and a socket that comes back. */

/**
 * Ask for JSON, or send JSON.
 * @param {string} path
 * @param {unknown} [body] sent where given
 * @returns {Promise<any>}
 * @throws {Error} with one line for people, where the server refuses or is away
 */
export async function json(path, body) {
  let answer;
  try {
    answer = await fetch(path, body === undefined ? {} : {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify(body),
    });
  } catch {
    throw new Error("the program does not answer; it may have ended");
  }
  if (answer.ok) return answer.json();
  throw new Error((await answer.text()).trim() || `refused (${answer.status})`);
}

/**
 * Open a socket to the server, and open it again whenever it is lost.
 * @param {string} path
 * @param {{
 *   text?: (content: any) => void,
 *   binary?: (content: ArrayBuffer) => void,
 *   open?: (open: boolean) => void,
 * }} to what takes messages, and news of the connection
 */
export function liveLink(path, to) {
  let pause = 200;
  const connect = () => {
    const socket = new WebSocket(`ws://${location.host}${path}`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      pause = 200;
      to.open?.(true);
    };
    socket.onmessage = (event) => {
      if (typeof event.data === "string") to.text?.(JSON.parse(event.data));
      else to.binary?.(event.data);
    };
    socket.onclose = () => {
      to.open?.(false);
      setTimeout(connect, pause);
      pause = Math.min(2000, pause * 1.6);
    };
  };
  connect();
}
