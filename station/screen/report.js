"use strict";
/* What a finger, a mouse or a key does in a report. All that is shown is in the page
   without this script; it zooms, reads values off, turns bodies, moves shapes and saves. */
const WIDTH = 8000, HEIGHT = 4000;

function button(text, name, act) {
  const made = document.createElement("button");
  made.type = "button"; made.className = name; made.textContent = text;
  made.addEventListener("click", act);
  return made;
}

function short(value) {
  const size = Math.abs(value);
  return size && (size < 1e-3 || size >= 1e6) ? value.toExponential(3) : String(Number(value.toPrecision(5)));
}

/* An axis: its ends, and the part of it that is in view. */
function axisOf(text) {
  const [low, high, log] = text.split(" ").map(Number);
  return {low, high, log: log === 1, at: (share) => { const v = low + share * (high - low); return log === 1 ? 10 ** v : v; },
    share: (value) => ((log === 1 ? Math.log10(value) : value) - low) / (high - low)};
}

function steps(axis, from, to) {
  const low = axis.at(from), high = axis.at(to);
  if (axis.log && high / low > 8) {
    const found = [], factors = high / low < 300 ? [1, 2, 5] : [1];
    for (let p = Math.floor(Math.log10(low)); p <= Math.log10(high); p += 1) {
      for (const f of factors) if (f * 10 ** p >= low && f * 10 ** p <= high) found.push(f * 10 ** p);
    }
    return found;
  }
  const rough = (high - low) / 5, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((s) => s * power >= rough) || 10);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k += 1) found.push(k * step);
  return found;
}

function zoomable(panel) {
  const x = axisOf(panel.dataset.x), y = axisOf(panel.dataset.y);
  const box = panel.querySelector(".box"), svg = box.querySelector("svg");
  const read = document.createElement("span"); read.className = "read"; read.hidden = true;
  const frame = document.createElement("span"); frame.className = "drag"; frame.hidden = true;
  box.append(read, frame);
  const [least, most] = (panel.dataset.reach || "0 1").split(" ").map(Number);
  let view = {x0: 0, x1: 1, y0: 0, y1: 1}, start = null;
  const marks = {x: panel.querySelector(".xm"), y: panel.querySelector(".ym:not(.over)"), over: panel.querySelector(".ym.over")};
  const first = {x: marks.x && marks.x.innerHTML, y: marks.y.innerHTML,
    gx: svg.querySelector(".gx").getAttribute("d"), gy: svg.querySelector(".gy").getAttribute("d")};
  const whole = () => view.x0 === 0 && view.x1 === 1 && view.y0 === 0 && view.y1 === 1;

  function write(holder, values, share, side, full) {
    if (!holder) return;
    holder.replaceChildren(...values.map((value) => {
      const one = document.createElement("span");
      one.textContent = short(value);
      one.style.setProperty(side, String(Math.round(share(value) * full)));
      return one;
    }));
  }
  function show(next) {
    const wide = Math.max(next.x1 - next.x0, 1e-4), tall = Math.max(next.y1 - next.y0, 1e-4);
    const x0 = Math.min(Math.max(next.x0, least), Math.max(most - wide, least)), y0 = Math.min(Math.max(next.y0, 0), Math.max(1 - tall, 0));
    view = {x0, x1: Math.min(x0 + wide, most), y0, y1: Math.min(y0 + tall, 1)};
    const w = (view.x1 - view.x0) * WIDTH, h = (view.y1 - view.y0) * HEIGHT;
    svg.setAttribute("viewBox", [view.x0 * WIDTH, (1 - view.y1) * HEIGHT, w, h].join(" "));
    const set = (name, value) => panel.style.setProperty(name, String(value));
    set("--x0", view.x0 * WIDTH); set("--xw", w); set("--y0", (1 - view.y1) * HEIGHT); set("--yw", h);
    if (marks.over) marks.over.style.visibility = whole() ? "" : "hidden";
    const hide = (one, name, low, size) => { const v = Number(one.style.getPropertyValue(name)); return v < low - 1 || v > low + size + 1; };
    for (const one of box.querySelectorAll(".mk, .tx")) {
      one.style.visibility = hide(one, "--x", view.x0 * WIDTH, w) || hide(one, "--y", (1 - view.y1) * HEIGHT, h) ? "hidden" : "";
    }
    if (whole()) {
      if (marks.x) marks.x.innerHTML = first.x;
      marks.y.innerHTML = first.y;
      svg.querySelector(".gx").setAttribute("d", first.gx); svg.querySelector(".gy").setAttribute("d", first.gy);
      return;
    }
    const across = steps(x, view.x0, view.x1), up = steps(y, view.y0, view.y1);
    write(marks.x, across, x.share, "--x", WIDTH);
    write(marks.y, up, (v) => 1 - y.share(v), "--y", HEIGHT);
    svg.querySelector(".gx").setAttribute("d", across.map((v) => `M${x.share(v) * WIDTH} 0V${HEIGHT}`).join(""));
    svg.querySelector(".gy").setAttribute("d", up.map((v) => `M0 ${(1 - y.share(v)) * HEIGHT}H${WIDTH}`).join(""));
  }
  function place(event) {
    const r = svg.getBoundingClientRect();
    return {px: event.clientX - r.left, py: event.clientY - r.top,
      x: view.x0 + (event.clientX - r.left) / r.width * (view.x1 - view.x0),
      y: view.y1 - (event.clientY - r.top) / r.height * (view.y1 - view.y0), w: r.width, h: r.height};
  }
  svg.addEventListener("pointermove", (event) => {
    const at = place(event);
    read.hidden = false;
    read.textContent = `${short(x.at(at.x))}, ${short(y.at(at.y))}`;
    if (!start) return;
    const flat = Math.abs(at.py - start.py) < 0.12 * at.h;
    Object.assign(frame.style, {left: `${Math.min(at.px, start.px)}px`, width: `${Math.abs(at.px - start.px)}px`,
      top: flat ? "0" : `${Math.min(at.py, start.py)}px`, height: flat ? "100%" : `${Math.abs(at.py - start.py)}px`});
    frame.hidden = Math.abs(at.px - start.px) < 6;
  });
  svg.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    start = place(event); svg.setPointerCapture(event.pointerId);
  });
  const stop = (event) => {
    if (start && event.type === "pointerup") {
      const at = place(event), flat = Math.abs(at.py - start.py) < 0.12 * at.h;
      if (Math.abs(at.px - start.px) >= 6) {
        show({x0: Math.min(start.x, at.x), x1: Math.max(start.x, at.x),
          y0: flat ? view.y0 : Math.min(start.y, at.y), y1: flat ? view.y1 : Math.max(start.y, at.y)});
      }
    }
    start = null; frame.hidden = true;
  };
  svg.addEventListener("pointerup", stop);
  svg.addEventListener("pointercancel", stop);
  svg.addEventListener("pointerleave", () => { read.hidden = true; });
  svg.addEventListener("dblclick", () => show({x0: 0, x1: 1, y0: 0, y1: 1}));
  return (key) => {
    const wide = view.x1 - view.x0, middle = (view.x0 + view.x1) / 2;
    const about = (w) => show({...view, x0: middle - w / 2, x1: middle + w / 2});
    if (key === "+" || key === "=") about(wide / 2);
    else if (key === "-") wide < 1 && wide * 2 >= 1 ? show({...view, x0: 0, x1: 1}) : about(Math.min(wide * 2, most - least));
    else if (key === "ArrowLeft") show({...view, x0: view.x0 - wide / 4, x1: view.x1 - wide / 4});
    else if (key === "ArrowRight") show({...view, x0: view.x0 + wide / 4, x1: view.x1 + wide / 4});
    else if (key === "0") show({x0: 0, x1: 1, y0: 0, y1: 1});
    else return false;
    return true;
  };
}

const VIRIDIS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"];

function colourOf(holder, text) {
  const probe = document.createElement("i");
  const name = /class="([^"]*)"/.exec(text), own = /--c:([^";]*)/.exec(text);
  if (name) probe.className = name[1];
  if (own) probe.style.setProperty("--c", own[1]);
  probe.style.color = "var(--c)";
  holder.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}

/* A scene: bodies as triangles, wires as lines; it turns, and its wire swings. */
function turnable(holder) {
  const scene = JSON.parse(holder.querySelector(".scene").textContent);
  const still = holder.querySelector("svg");
  const canvas = document.createElement("canvas");
  canvas.hidden = true;
  holder.append(canvas);
  let turn = 0, tilt = 0, phase = 0, playing = false, held = null;
  const [right, up, eye] = scene.axes;
  const dot = (a, x, y, z) => a[0] * x + a[1] * y + a[2] * z;

  function flat(p) {
    const found = new Array(p.length), c = Math.cos(turn), s = Math.sin(turn), ct = Math.cos(tilt), st = Math.sin(tilt);
    for (let k = 0; k < p.length; k += 3) {
      if (p[k] === null) { found[k] = null; continue; }
      const x = c * p[k] - s * p[k + 1], y = s * p[k] + c * p[k + 1], z = p[k + 2];
      const v = dot(up, x, y, z), w = dot(eye, x, y, z);
      found[k] = dot(right, x, y, z); found[k + 1] = ct * v - st * w; found[k + 2] = st * v + ct * w;
    }
    return found;
  }
  function draw() {
    const ratio = window.devicePixelRatio || 1, r = holder.getBoundingClientRect();
    canvas.width = r.width * ratio; canvas.height = r.height * ratio;
    const pen = canvas.getContext("2d"), size = Math.min(r.width, r.height) / 2 / (1.04 * scene.half);
    pen.scale(ratio, ratio); pen.translate(r.width / 2, r.height / 2); pen.scale(size, -size);
    for (const one of scene.parts) {
      const ink = one.ink || (one.ink = colourOf(holder, one.k));
      if (one.t) { body(pen, one, ink, flat(one.p)); continue; }
      let p = one.p;
      if (one.re) p = p.map((v, k) => v === null ? null : v + (Math.cos(phase) - 1) * one.re[k] - Math.sin(phase) * one.im[k]);
      wire(pen, one, ink, flat(p), 1 / size);
    }
  }
  function body(pen, one, ink, p) {
    const count = one.t.length / 3, depth = new Float64Array(count);
    for (let k = 0; k < count; k += 1) depth[k] = p[3 * one.t[3 * k] + 2] + p[3 * one.t[3 * k + 1] + 2] + p[3 * one.t[3 * k + 2] + 2];
    const order = Array.from({length: count}, (_, k) => k).sort((a, b) => depth[a] - depth[b]);
    pen.globalAlpha = one.o || 1; pen.lineWidth = 6;
    for (const k of order) {
      if (one.c) {
        const hex = VIRIDIS[Math.round(one.c[k] / 15 * 9)], light = 0.62 + 0.38 * one.s[k] / 5;
        const rgb = [0, 2, 4].map((i) => Math.round(light * parseInt(hex.slice(i, i + 2), 16)));
        pen.fillStyle = pen.strokeStyle = `rgb(${rgb})`;
      } else { pen.fillStyle = pen.strokeStyle = ink; }
      pen.beginPath();
      for (let i = 0; i < 3; i += 1) { const v = 3 * one.t[3 * k + i]; i ? pen.lineTo(p[v], p[v + 1]) : pen.moveTo(p[v], p[v + 1]); }
      pen.closePath(); pen.fill(); pen.stroke();
    }
    pen.globalAlpha = 1;
  }
  function wire(pen, one, ink, p, unit) {
    pen.strokeStyle = pen.fillStyle = ink; pen.lineWidth = 0.6 * one.w * unit;
    let open = false;
    pen.beginPath();
    for (let k = 0; k < p.length; k += 3) {
      if (p[k] === null) { open = false; continue; }
      open ? pen.lineTo(p[k], p[k + 1]) : pen.moveTo(p[k], p[k + 1]);
      open = true;
      if (one.m.includes("markers")) { pen.moveTo(p[k] + 2.5 * unit, p[k + 1]); pen.arc(p[k], p[k + 1], 2.5 * unit, 0, 7); pen.moveTo(p[k], p[k + 1]); }
    }
    if (one.m.includes("lines") || one.m.includes("markers")) pen.stroke();
    if (!one.m.includes("text")) return;
    (one.l || []).forEach((word, k) => {
      pen.save(); pen.translate(p[3 * k], p[3 * k + 1] + 8 * unit); pen.scale(unit, -unit); pen.textAlign = "center"; pen.font = "12px system-ui"; pen.fillText(word, 0, 0); pen.restore();
    });
  }
  function wake() { still.style.visibility = "hidden"; canvas.hidden = false; draw(); }
  const rest = () => { turn = tilt = phase = 0; playing = false; canvas.hidden = true; still.style.visibility = ""; };
  for (const target of [holder]) {
    target.addEventListener("pointerdown", (event) => { if (event.target.tagName !== "BUTTON") { held = event; target.setPointerCapture(event.pointerId); } });
    target.addEventListener("pointermove", (event) => {
      if (!held) return;
      turn += (event.clientX - held.clientX) / 150; tilt += (event.clientY - held.clientY) / 150; held = event; wake();
    });
    target.addEventListener("pointerup", () => { held = null; });
    target.addEventListener("pointercancel", () => { held = null; });
    target.addEventListener("dblclick", rest);
  }
  function swing() {
    if (!playing) return;
    phase += 0.14; wake();
    window.requestAnimationFrame(swing);
  }
  if (scene.parts.some((one) => one.re)) {
    const play = button("Play", "save", () => {
      playing = !playing; play.textContent = playing ? "Stop" : "Play";
      if (playing) swing();
    });
    holder.closest("figure").querySelector("figcaption").append(" ", play);
  }
  return (key) => {
    const step = {ArrowLeft: [-0.2, 0], ArrowRight: [0.2, 0], ArrowUp: [0, -0.2], ArrowDown: [0, 0.2]}[key];
    if (key === "0") { rest(); return true; }
    if (!step) return false;
    turn += step[0]; tilt += step[1]; wake();
    return true;
  };
}

/* A figure as one SVG file: panels where they stand, texts as texts, colours as seen. */
function saved(plot) {
  const around = plot.getBoundingClientRect(), space = "http://www.w3.org/2000/svg";
  const head = plot.dataset.title ? 34 : 6;
  const out = document.createElementNS(space, "svg");
  const add = (tag, settings, text) => {
    const one = document.createElementNS(space, tag);
    for (const [name, value] of Object.entries(settings)) one.setAttribute(name, value);
    if (text) one.textContent = text;
    out.append(one);
    return one;
  };
  const paper = getComputedStyle(document.documentElement).getPropertyValue("--paper");
  for (const [name, value] of Object.entries({xmlns: space, width: around.width + 12, height: around.height + head + 8, "font-family": "sans-serif"})) out.setAttribute(name, value);
  add("rect", {width: "100%", height: "100%", fill: paper});
  if (plot.dataset.title) add("text", {x: 6, y: 22, "font-size": 16, "font-weight": 600, fill: getComputedStyle(plot).color}, plot.dataset.title);
  for (const svg of plot.querySelectorAll("svg")) {
    const r = svg.getBoundingClientRect(), copy = svg.cloneNode(true);
    const from = svg.querySelectorAll("*"), to = copy.querySelectorAll("*");
    from.forEach((one, k) => {
      const seen = getComputedStyle(one);
      for (const name of ["stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "fill", "fill-opacity", "opacity", "vector-effect"]) to[k].style.setProperty(name, seen.getPropertyValue(name));
    });
    for (const [name, value] of Object.entries({x: r.left - around.left + 6, y: r.top - around.top + head, width: r.width, height: r.height})) copy.setAttribute(name, value);
    out.append(copy);
    add("path", {d: `M${r.left - around.left + 6} ${r.top - around.top + head}v${r.height}h${r.width}`, fill: "none", stroke: "#8a97a5"});
  }
  for (const one of plot.querySelectorAll("span, b, i, p, li")) {
    const own = [...one.childNodes].filter((n) => n.nodeType === 3).map((n) => n.textContent).join("").trim();
    const r = one.getBoundingClientRect(), seen = getComputedStyle(one);
    if (one.matches(".sw.stroke, .sw.area, .sw.block")) {
      add("rect", {x: r.left - around.left + 6, y: r.top - around.top + head, width: r.width, height: Math.max(r.height, 2), fill: seen.color});
    }
    if (!own || !r.width || one.classList.contains("read")) continue;
    const first = one.querySelector("i"), shift = first ? first.getBoundingClientRect().right - r.left + 6 : 0;
    const centred = seen.textAlign === "center" && !first;
    add("text", {x: r.left - around.left + 6 + (centred ? r.width / 2 : shift), y: r.bottom - around.top + head - 0.28 * r.height, "font-size": seen.fontSize,
      fill: seen.color, "text-anchor": centred ? "middle" : "start", "font-weight": seen.fontWeight}, own);
  }
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(out)], {type: "image/svg+xml"}));
  link.download = `${plot.id}.svg`;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

for (const plot of document.querySelectorAll(".plot[id]")) {
  const act = [...plot.querySelectorAll(".panel[data-x]")].map(zoomable).concat([...plot.querySelectorAll(".solid")].map(turnable));
  if (act.length) {
    plot.tabIndex = 0;
    plot.addEventListener("keydown", (event) => {
      if (event.target !== plot || event.ctrlKey || event.metaKey || event.altKey) return;
      if (act.map((one) => one(event.key)).some(Boolean)) event.preventDefault();
    });
  }
  const caption = plot.parentElement.querySelector("figcaption");
  if (caption && plot.querySelector("svg")) {
    const save = button("Save as SVG", "save", () => saved(plot));
    save.setAttribute("aria-label", `Save as SVG: ${caption.textContent}`);
    caption.append(" ", save);
  }
}
window.addEventListener("beforeprint", () => {
  for (const one of document.querySelectorAll("details")) one.open = true;
});
