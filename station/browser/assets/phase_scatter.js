// SPDX-License-Identifier: MIT
/** The components of a shape in the complex plane: a real mode lies on one line. */

import { colour } from "./theme.js";

/**
 * @param {HTMLCanvasElement} canvas square, drawn anew
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
  const many = labels.length > 12;
  mode.shape_re.forEach((re, i) => {
    const x = middle + scale * re;
    const y = middle - scale * mode.shape_im[i];
    context.strokeStyle = context.fillStyle = colour("curve-1");
    context.lineWidth = 1.6;
    context.beginPath();
    context.moveTo(middle, middle);
    context.lineTo(x, y);
    context.stroke();
    context.beginPath();
    context.arc(x, y, 3.5, 0, 7);
    context.fill();
    if (!many) {
      context.fillStyle = colour("ink");
      context.textAlign = x > middle + 0.5 * scale ? "right" : "left";
      context.fillText(labels[i].split("@").pop() || labels[i], x + (x > middle + 0.5 * scale ? -7 : 7), y - 6 - 12 * (i % 2));
    }
  });
  context.textAlign = "left";
}
