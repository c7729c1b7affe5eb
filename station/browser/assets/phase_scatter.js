// SPDX-License-Identifier: MIT
/** The components of a shape in the complex plane: a real mode lies on one line. */

import { colour } from "./theme.js";

/**
 * @param {HTMLCanvasElement} canvas square, drawn again
 * @param {{shape_re: number[], shape_im: number[]}} mode
 * @param {string[]} labels
 */
export function phaseScatter(canvas, mode, labels) {
  const size = 260;
  const ratio = window.devicePixelRatio || 1;
  canvas.width = canvas.height = size * ratio;
  canvas.style.width = canvas.style.height = `${size}px`;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const middle = size / 2;
  const scale = 0.4 * size;
  context.strokeStyle = colour("line");
  context.lineWidth = 1;
  for (const share of [0.5, 1]) {
    context.beginPath();
    context.arc(middle, middle, share * scale, 0, 7);
    context.stroke();
  }
  context.beginPath();
  context.moveTo(middle - 1.1 * scale, middle);
  context.lineTo(middle + 1.1 * scale, middle);
  context.moveTo(middle, middle - 1.1 * scale);
  context.lineTo(middle, middle + 1.1 * scale);
  context.stroke();
  context.fillStyle = colour("soft");
  context.font = "13px system-ui, sans-serif";
  context.fillText("Re", size - 24, middle - 6);
  context.fillText("Im", middle + 6, 14);
  const points = mode.shape_re.map((re, i) => ({ x: middle + scale * re, y: middle - scale * mode.shape_im[i], i }));
  for (const { x, y } of points) {
    context.strokeStyle = context.fillStyle = colour("curve-1");
    context.lineWidth = 1.6;
    context.beginPath();
    context.moveTo(middle, middle);
    context.lineTo(x, y);
    context.stroke();
    context.beginPath();
    context.arc(x, y, 3.5, 0, 7);
    context.fill();
  }
  context.fillStyle = colour("ink");
  for (const group of labels.length > 12 ? [] : together(points)) {
    const { x, y } = group[0];
    const right = x > middle + 0.5 * scale;
    context.textAlign = right ? "right" : "left";
    const words = group.map(({ i }) => labels[i].split("@").pop() || labels[i]).join(", ");
    context.fillText(words, x + (right ? -7 : 7), y - 8);
  }
  context.textAlign = "left";
}

/**
 * Group points whose labels would lie on each other.
 * @param {{x: number, y: number, i: number}[]} points
 */
function together(points) {
  /** @type {(typeof points)[]} */
  const groups = [];
  for (const one of points) {
    const near = groups.find(([first]) => Math.abs(first.x - one.x) < 40 && Math.abs(first.y - one.y) < 14);
    if (near) near.push(one);
    else groups.push([one]);
  }
  return groups;
}
