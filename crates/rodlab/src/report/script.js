// Interactive figures: values under the cursor, zoom, linear and logarithmic scales, curves that can be hidden. Ranges and ticks are those of rodfigure.
"use strict";
const abs = Math.abs, lg = Math.log10;
const esc = (s) => s.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const sup = (n) => String(n).replace(/[-\d]/g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]));
const power = (v) => Math.floor(lg(abs(v)) + 1e-9);
const fixed = (v, n) => v.toFixed(Math.min(Math.max(n, 0), 17)).replace("-", "−");
const title = (a) => a.l + (a.u && `, ${a.u}`);
const is = Number.isFinite;

function label(v, step) {
  if (abs(v) < 1e-6 * step) return "0";
  const p = power(v);
  if (abs(v) < 99999.5 && !(step < 0.99e-3 && abs(v) < 0.1)) return fixed(v, -power(step));
  const m = fixed(v / 10 ** p, p - power(step));
  return (m === "1" ? "" : m === "−1" ? "−" : `${m}×`) + "10" + sup(p);
}
function value(v) {
  const p = v && power(v);
  return p < -3 || p > 5 ? `${+(v / 10 ** p).toPrecision(5)}×10${sup(p)}` : String(+v.toPrecision(5));
}
function ticks(log, [from, to], wanted, unit) {
  const major = [], minor = [], decades = log ? lg(to / from) : 0;
  if (decades < 1) {
    const least = (to - from) / wanted, ten = 10 ** Math.floor(lg(least));
    const step = (/^(°|deg)$/.test(unit) && to - from > 60 && [15, 30, 45, 90, 180, 360].find((s) => s >= least)) || ten * ([1, 2, 5].find((s) => s * ten >= least * (1 - 1e-9)) || 10);
    for (let n = Math.ceil(from / step - 1e-9); n * step <= to + 1e-9 * step; n++) major.push([n * step, label(n * step, step)]);
    const lead = Math.round((1e6 * step) / 10 ** power(step)) / 1e6, parts = lead === 2 ? 4 : lead === 1 || lead === 5 ? 5 : 3, part = step / parts;
    for (let n = Math.ceil(from / part - 1e-9); n * part <= to + 1e-9 * part; n++) if (n % parts) minor.push(n * part);
    return { major, minor };
  }
  const every = Math.max(1, Math.ceil(decades / wanted));
  for (let e = Math.floor(lg(from)); e <= lg(to) + 1e-9; e++)
    for (let d = 1; d < 10; d++) {
      const v = d * 10 ** e;
      if (v < from * (1 - 1e-9) || v > to * (1 + 1e-9)) continue;
      if ((d === 1 && e % every === 0) || (decades < 1.6 && (d === 2 || d === 5)))
        major.push([v, decades > 5.5 && e ? "10" + sup(e) : label(v, v)]);
      else if (every === 1) minor.push(v);
    }
  return { major, minor };
}
function widened([a, b], log, margin) {
  if (a > b) return log ? [1, 10] : [0, 1];
  if (log) return b / a < 1 + 1e-9 ? [a / 2, b * 2] : [a / (b / a) ** margin, b * (b / a) ** margin];
  const free = b - a <= 1e-12 * Math.max(abs(a), abs(b)) ? 0.1 * abs(b) || 1 : margin * (b - a);
  return [a - free, b + free];
}
const inLines = (axis, most) => title(axis).split(" ").reduce((lines, word) => {
  if (lines.length && 6.4 * (lines.at(-1) + word).length < most) lines.push(`${lines.pop()} ${word}`);
  else lines.push(word);
  return lines;
}, []);
const MARKERS = ["m-2.8 0a2.8 2.8 0 1 0 5.6 0a2.8 2.8 0 1 0-5.6 0z", "m-2.6-2.6h5.2v5.2h-5.2z", "m0-3.6l3.2 5.8h-6.4z", "m0-3.7l3.7 3.7-3.7 3.7-3.7-3.7z",
  "m0 3.6l3.2-5.8h-6.4z", "m-3-3l6 6m-6 0l6-6", "m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0z"];
// saved panels fit a journal column of 84 mm; at this scale their text has a size of nine points
const COLUMN = 318, COLUMN_MM = 84, DOTS = 1984;
const LOOK = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "font-family", "font-size", "text-anchor"];
let clips = 0;

// calls `act` with the colours for paper, even if the screen shows the dark ones
function onPaper(act) {
  const root = document.documentElement, light = document.styleSheets[0].cssRules[0].style;
  for (const name of light) if (name.startsWith("--")) root.style.setProperty(name, light.getPropertyValue(name));
  act();
  root.removeAttribute("style");
}
function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1e4);
}

function figure(box) {
  const data = JSON.parse(box.querySelector("script").textContent);
  let width = 0;
  const views = {}, legends = {}, panels = data.p.map(panel);
  const fit = (wanted) => wanted !== width && ((width = wanted), panels.forEach((p) => p.draw()));
  const screen = () => fit(Math.max(box.clientWidth, 240));
  addEventListener("resize", screen);
  // 680 px is the width of a printed page, so that the text keeps its size
  addEventListener("beforeprint", () => fit(680));
  addEventListener("afterprint", screen);
  screen();

  function panel(p) {
    const view = (views[title(p.x) + p.x.s] ??= { log: p.x.s, zoom: null, panels: [] });
    view.panels.push(p);
    const own = { view, log: p.y.s, zoom: null };
    const clip = `c${clips++}`;
    const curves = p.m.filter((m) => m.t !== "a"), at = p.m.filter((m) => m.t === "a");
    curves.forEach((m) => (m.x = data.x[m.x]));
    const el = box.appendChild(document.createElement("div"));
    const names = [...new Set(curves.map((m) => m.n).filter(Boolean))], greys = [...new Set(p.g.map((g) => g[2]))];
    // panels with the same curves have one legend
    const legend = (legends[JSON.stringify([curves.filter((m) => m.n).map((m) => [m.n, m.t, m.r]), greys])] ??= { hidden: new Set(), panels: [] });
    const hidden = legend.hidden, is_first = legend.panels.push(own) === 1;
    const swatch = (m) => `<svg width="26" height="12">${m.t === "b" ? `<path class="b s${m.r}" d="M0 0h26v12h-26z"/>` : m.t === "p" ? `<path class="p s${m.r}" d="M13 6${MARKERS[m.r]}"/>` : `<path class="l s${m.r}" d="M0 6h26"/>`}</svg>`;
    el.innerHTML = `<div class="legend"${is_first ? "" : " hidden"}>${names.map((n) => `<button aria-pressed="true">${curves.filter((m) => m.n === n).map(swatch).join("")}${esc(n)}</button>`).join("")}
${greys.map((n) => `<span><svg width="26" height="12"><path class="g" d="M0 0h26v12h-26z"/></svg>${esc(n)}</span>`).join("")}</div>
<svg tabindex="0" role="application" aria-label="${esc(`${title(p.y)} against ${title(p.x)}. Arrow keys read values, plus and minus zoom, escape resets.`)}"></svg>
<div class="tools"><output aria-live="polite"></output><span>${["+", "−", "reset", "log x", "log y", "SVG", "PNG", "PDF"].map((b) => `<button${b[0] === "l" ? ' aria-pressed="false"' : ""}>${b}</button>`).join("")}</span></div>`;
    const svg = el.children[1], out = el.querySelector("output"), tools = [...el.querySelectorAll(".tools button")];
    let fx, fy, rx, ry, left, right, top, bottom, cursor = null;

    function spans() {
      const lx = view.log, ly = own.log, on = (v, log) => is(v) && (!log || v > 0), shown = curves.filter((m) => !hidden.has(m.n));
      const grow = (r, v, log) => on(v, log) && ((r[0] = Math.min(r[0], v)), (r[1] = Math.max(r[1], v)));
      const fits = (r, log) => r && r[0] < r[1] && (!log || r[0] > 0) && r;
      rx = view.zoom || [p, ...view.panels].map((q) => fits(q.x.r, lx)).find((r) => r);
      if (!rx) {
        const r = [1 / 0, -1 / 0];
        let margin = 0;
        for (const q of view.panels)
          for (const m of q.m) {
            (m.x || [m.v]).forEach((v) => grow(r, v, lx));
            if (q.e || m.t === "p") margin = 0.05;
          }
        rx = widened(r, lx, margin);
      }
      ry = own.zoom || fits(p.y.r, ly);
      if (!ry) {
        let core = [1 / 0, -1 / 0];
        const reach = [1 / 0, -1 / 0];
        for (const m of shown)
          m.x.forEach((x, i) => {
            if (!on(x, lx) || x < rx[0] || x > rx[1]) return;
            grow(m.t === "b" ? reach : core, m.y[i], ly);
            if (m.t === "b") grow(reach, m.z[i], ly);
            else if (m.z && is(m.z[i])) [-1, 1].forEach((s) => grow(reach, m.y[i] + s * m.z[i], ly));
          });
        own.empty = core[0] > core[1] && reach[0] > reach[1];
        if (core[0] > core[1]) core = reach;
        else if (reach[0] <= reach[1]) {
          const to = ly ? lg : (v) => v, back = ly ? (v) => 10 ** v : (v) => v, span = to(core[1]) - to(core[0]);
          core = [Math.min(core[0], span ? Math.max(reach[0], back(to(core[0]) - 0.6 * span)) : reach[0]),
            Math.max(core[1], span ? Math.min(reach[1], back(to(core[1]) + 0.6 * span)) : reach[1])];
        }
        ry = widened(core, ly, 0.05);
      }
    }
    const map = (log, r, a, b) => {
      const t = log ? lg : (v) => v, k = (b - a) / (t(r[1]) - t(r[0])), o = t(r[0]);
      const f = (v) => (v === null || (log && v <= 0) ? NaN : Math.round(10 * Math.min(Math.max(a + (t(v) - o) * k, -5e3), 9e3)) / 10);
      f.back = (px) => (log ? 10 ** (o + (px - a) / k) : o + (px - a) / k);
      return f;
    };
    const path = (m) => {
      let d = "", pen = 0;
      if (m.t === "p") {
        m.x.forEach((x, i) => is(fx(x)) && is(fy(m.y[i])) && (d += `M${fx(x)} ${fy(m.y[i])}${MARKERS[m.r]}`));
        let bars = "";
        if (m.z) m.x.forEach((x, i) => {
          if (!is(m.z[i] + fx(x) + fy(m.y[i]))) return;
          const low = fy(m.y[i] - m.z[i]);
          bars += `M${fx(x)} ${is(low) ? low : 9e3}V${fy(m.y[i] + m.z[i])}m-2.5 0h5${is(low) ? `M${fx(x) - 2.5} ${low}h5` : ""}`;
        });
        return (bars && `<path class="e s${m.r}" d="${bars}"/>`) + `<path class="p s${m.r}" d="${d}"/>`;
      }
      if (m.t === "b") {
        const edge = (v) => (own.log && v !== null && v <= 0 ? 9e3 : fy(v));
        let back = "";
        const end = () => { if (pen) d += back + "z"; back = ""; pen = 0; };
        m.x.forEach((x, i) => {
          const a = fx(x), u = edge(m.z[i]), l = edge(m.y[i]);
          if (!is(a + u + l)) return end();
          d += `${pen++ ? "L" : "M"}${a} ${u}`;
          back = `L${a} ${l}${back}`;
        });
        end();
        return `<path class="b s${m.r}" d="${d}"/>`;
      }
      m.x.forEach((x, i) => {
        const a = fx(x), b = fy(m.y[i]);
        if (is(a + b)) d += pen++ ? ` ${a} ${b}` : `M${a} ${b}L${a} ${b}`;
        else pen = 0;
      });
      return `<path class="l s${m.r}" d="${d}"/>`;
    };
    function draw() {
      spans();
      const w = width;
      right = w - 22;
      let high = p.e ? Math.min(w - 70, 420) : 230;
      const ny = Math.floor(high / 45);
      const label = inLines(p.y, high);
      left = 22 + 14 * Math.max(...data.p.map((q) => inLines(q.y, high).length)) + 6.3 * Math.max(...ticks(own.log, ry, ny, p.y.u).major.map((t) => t[1].length), 5);
      if (p.e && !view.log && !own.log) {
        const k = Math.max((rx[1] - rx[0]) / (right - left), (ry[1] - ry[0]) / high);
        const wide = (r, n) => [(r[0] + r[1] - k * n) / 2, (r[0] + r[1] + k * n) / 2];
        rx = wide(rx, right - left);
        ry = wide(ry, high);
      }
      fx = map(view.log, rx, left, right);
      const lines = at.map((m) => ({ n: m.n, v: fx(m.v), row: 0 })).filter((l) => l.v >= left && l.v <= right).sort((a, b) => a.v - b.v);
      const placed = [];
      lines.forEach((l) => (l.x = Math.max(left, Math.min(l.v + 3, right - 6.2 * l.n.length)), (l.end = l.x + 6.2 * l.n.length + 6)));
      const place_above = (l, under) => ((l.row = Math.max(-1, ...placed.filter(under).map((o) => o.row)) + 1), placed.push(l));
      lines.filter((l) => l.x > l.v).reverse().forEach((l) => place_above(l, (o) => o.v < l.end));
      lines.filter((l) => l.x <= l.v).forEach((l) => place_above(l, (o) => o.end > l.x && o.v - 6 < l.end));
      top = 8 + 14 * Math.max(0, ...lines.map((l) => l.row + 1));
      bottom = top + high;
      fy = map(own.log, ry, bottom, top);
      const tx = ticks(view.log, rx, Math.floor((right - left) / 55), p.x.u), ty = ticks(own.log, ry, ny, p.y.u);
      let grid = "", frame = `M${left} ${top}H${right}V${bottom}H${left}z`, text = "";
      tx.major.forEach(([v, t]) => ((grid += `M${fx(v)} ${top}V${bottom}`), (frame += `M${fx(v)} ${bottom}v5`), (text += `<text x="${Math.min(fx(v), w - 3.4 * t.length - 1)}" y="${bottom + 17}" text-anchor="middle">${t}</text>`)));
      ty.major.forEach(([v, t]) => ((grid += `M${left} ${fy(v)}H${right}`), (frame += `M${left} ${fy(v)}h-5`), (text += `<text x="${left - 8}" y="${fy(v) + 4}" text-anchor="end">${t}</text>`)));
      tx.minor.forEach((v) => (frame += `M${fx(v)} ${bottom}v3`));
      ty.minor.forEach((v) => (frame += `M${left} ${fy(v)}h-3`));
      const end = (v, other) => Math.min(Math.max(v === null || !is(fx(v)) ? other : fx(v), left), right);
      svg.setAttribute("viewBox", `0 0 ${w} ${bottom + 42}`);
      svg.innerHTML = `<clipPath id="${clip}"><path d="M${left} ${top}H${right}V${bottom}H${left}z"/></clipPath><g clip-path="url(#${clip})">
${p.g.map((g) => `<path class="g" d="M${end(g[0], left)} ${top}H${end(g[1], right)}V${bottom}H${end(g[0], left)}z"/>`).join("")}<path class="grid" d="${grid}"/>
${lines.map((l) => `<path class="at" d="M${l.v} ${top}V${bottom}"/>`).join("")}${curves.filter((m) => !hidden.has(m.n)).map(path).join("")}<g class="cursor"></g></g>
${lines.map((l) => `<path class="axis" d="M${l.v} ${top}v${-3 - 14 * l.row}"/><text x="${l.x}" y="${top - 4 - 14 * l.row}">${esc(l.n)}</text>`).join("")}<path class="axis" d="${frame}"/>${text}${own.empty ? `<text x="${(left + right) / 2}" y="${(top + bottom) / 2}" text-anchor="middle">no data to show</text>` : ""}
<text x="${(left + right) / 2}" y="${bottom + 36}" text-anchor="middle">${esc(title(p.x))}</text>${label.map((l, i) => `<text transform="translate(${14 + 14 * i} ${(top + bottom) / 2})rotate(-90)" text-anchor="middle">${esc(l)}</text>`).join("")}`;
      tools[3].setAttribute("aria-pressed", !!view.log);
      tools[4].setAttribute("aria-pressed", !!own.log);
      cursor = null;
    }
    own.draw = draw;

    // shows the values of all curves at the sample nearest to a position
    function read(px, py) {
      const shown = curves.filter((m) => !hidden.has(m.n));
      const far = (m, i) => (is(fx(m.x[i])) && is(fy(m.y[i])) ? (p.e ? Math.hypot(fx(m.x[i]) - px, fy(m.y[i]) - py) : abs(fx(m.x[i]) - px)) : 1 / 0);
      const near = shown.map((m) => m.x.reduce((best, _, i) => (far(m, i) < best[1] ? [i, far(m, i)] : best), [0, 1 / 0]));
      const best = near.reduce((a, n, k) => (n[1] < (near[a] || [0, 1 / 0])[1] ? k : a), -1);
      if (best < 0) return;
      const x = shown[best].x[near[best][0]], unit = (a) => a.u && ` ${a.u}`;
      let dots = `<path class="at" d="M${fx(x)} ${top}V${bottom}"/>`, words = `${p.x.l} ${value(x)}${unit(p.x)}`;
      shown.forEach((m, k) => {
        const [i, d] = near[k];
        if (!is(d) || abs(fx(m.x[i]) - fx(x)) > 6 || (p.e && k !== best)) return;
        if (m.t !== "b") dots += `<circle class="s${m.r}" cx="${fx(m.x[i])}" cy="${fy(m.y[i])}" r="4"/>`;
        words += `; ${m.n || p.y.l} ${value(m.y[i])}` + (m.t === "b" ? is(m.z[i]) ? ` to ${value(m.z[i])}` : "" : m.z && is(m.z[i]) ? ` ± ${value(m.z[i])}` : "") + unit(p.y);
      });
      cursor = [shown[best], near[best][0]];
      svg.querySelector(".cursor").innerHTML = dots;
      out.textContent = words;
    }
    // sets the range `r` of an axis, unless it is too narrow for the precision of numbers or too large
    const to = (state, r) => r.every((v) => abs(v) < 1e99 && (!state.log || v > 1e-99)) && r[1] - r[0] > 1e-9 * Math.max(abs(r[0]), abs(r[1])) && (state.zoom = r);
    const zoom = (by, px = (left + right) / 2) => {
      to(view, [left, right].map((v) => fx.back(px + (v - px) * by)));
      if (p.e) to(own, [bottom, top].map((v) => fy.back((top + bottom) / 2 + (v - (top + bottom) / 2) * by)));
      redraw();
    };
    const redraw = () => panels.forEach((o) => o.view === view && o.draw());
    const reset = () => { view.zoom = null; panels.forEach((o) => o.view === view && (o.zoom = null)); out.textContent = ""; redraw(); };
    const place = (e) => { const r = svg.getBoundingClientRect(), k = svg.viewBox.baseVal.width / r.width; return [(e.clientX - r.left) * k, (e.clientY - r.top) * k]; };
    const down = new Map();
    let from = null, spread = 0;
    svg.onpointerdown = (e) => {
      down.set(e.pointerId, place(e));
      from = e.pointerType === "touch" ? null : place(e);
      spread = 0;
      try { svg.setPointerCapture(e.pointerId); } catch { /* the pointer was released already */ }
    };
    svg.onpointermove = (e) => {
      const [x, y] = place(e);
      if (down.has(e.pointerId)) down.set(e.pointerId, [x, y]);
      if (down.size === 2) {
        const [a, b] = [...down.values()], now = Math.hypot(a[0] - b[0], a[1] - b[1]) || 1;
        if (spread) zoom(spread / now, (a[0] + b[0]) / 2);
        spread = now;
      } else if (from && abs(x - from[0]) > 4) {
        const tall = p.e || abs(y - from[1]) > 40;
        svg.querySelector(".cursor").innerHTML = `<path class="box" d="M${from[0]} ${tall ? from[1] : top}H${x}V${tall ? y : bottom}H${from[0]}z"/>`;
      } else read(x, y);
    };
    svg.onpointerup = (e) => {
      down.delete(e.pointerId);
      const [x, y] = place(e), was = from;
      from = null;
      if (!was || abs(x - was[0]) < 8) return;
      const sort = (a, b) => [Math.min(a, b), Math.max(a, b)], inside = (v, a, b) => Math.min(Math.max(v, a), b);
      if (p.e || abs(y - was[1]) > 40) to(own, sort(...[y, was[1]].map((v) => fy.back(inside(v, top, bottom)))));
      to(view, sort(...[x, was[0]].map((v) => fx.back(inside(v, left, right)))));
      redraw();
    };
    svg.onpointerleave = svg.onpointercancel = (e) => {
      down.delete(e.pointerId);
      from = null;
      svg.querySelector(".cursor").innerHTML = "";
    };
    svg.ondblclick = reset;
    // until the figure is clicked, the wheel scrolls the page
    svg.addEventListener("wheel", (e) => {
      if (document.activeElement !== svg && !e.ctrlKey) return;
      e.preventDefault();
      zoom(e.deltaY > 0 ? 1.25 : 0.8, place(e)[0]);
    }, { passive: false });
    svg.onkeydown = (e) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
      if (step) {
        if (!cursor) read(left, bottom);
        else {
          const [m] = cursor;
          let i = cursor[1];
          for (let n = e.shiftKey ? 10 : 1; n--; ) {
            let next = i + step;
            while (next in m.x && !is(fx(m.x[next]) + fy(m.y[next]))) next += step;
            if (next in m.x) i = next;
          }
          read(fx(m.x[i]), fy(m.y[i]));
        }
      } else if (e.key === "+" || e.key === "-") zoom(e.key === "+" ? 0.8 : 1.25);
      else if (e.key === "Escape") reset();
      else return;
      e.preventDefault();
    };
    // returns the panel as an SVG file, with its legend above it
    function file() {
      const was = width;
      let text;
      onPaper(() => {
        fit(COLUMN);
        const shown = names.filter((n) => !hidden.has(n)), more = shown.length && 16 * shown.length + 3, high = svg.viewBox.baseVal.height + more;
        const above = svg.appendChild(document.createElementNS(svg.namespaceURI, "g"));
        above.innerHTML = shown.map((n, i) => `<g transform="translate(${left} ${16 * i + 3 - more})">${curves.filter((m) => m.n === n).map(swatch).join("")}<text x="32" y="10">${esc(n)}</text></g>`).join("");
        const copy = svg.cloneNode(true), parts = copy.querySelectorAll("*");
        svg.querySelectorAll("*").forEach((part, i) => {
          const style = getComputedStyle(part);
          if (!/^(clipPath|svg)$/.test(part.tagName)) LOOK.forEach((name) => parts[i].setAttribute(name, style.getPropertyValue(name)));
          parts[i].removeAttribute("class");
        });
        ["tabindex", "role", "aria-label"].forEach((name) => copy.removeAttribute(name));
        copy.setAttribute("xmlns", svg.namespaceURI);
        copy.setAttribute("viewBox", `0 ${-more} ${COLUMN} ${high}`);
        copy.setAttribute("width", `${COLUMN_MM}mm`);
        copy.setAttribute("height", `${Math.round((1e3 * COLUMN_MM * high) / COLUMN) / 1e3}mm`);
        text = copy.outerHTML;
      });
      fit(was);
      return text;
    }
    const name = `${box.dataset.name}${data.p.length > 1 ? `-${data.p.indexOf(p) + 1}` : ""}`;
    const svgFile = () => download(new Blob([file()], { type: "image/svg+xml" }), `${name}.svg`);
    const pngFile = () => {
      const image = new Image();
      image.onload = () => {
        const canvas = document.createElement("canvas"), pen = canvas.getContext("2d");
        canvas.width = DOTS;
        canvas.height = Math.round((DOTS * image.height) / image.width);
        pen.fillStyle = "#fff";
        pen.fillRect(0, 0, canvas.width, canvas.height);
        pen.drawImage(image, 0, 0, canvas.width, canvas.height);
        canvas.toBlob((blob) => download(blob, `${name}.png`));
      };
      image.src = `data:image/svg+xml,${encodeURIComponent(file())}`;
    };
    const pdfFile = () => {
      const { text, lost } = pdf(file(), title(p.y), COLUMN_MM);
      download(new Blob([text], { type: "application/pdf" }), `${name}.pdf`);
      if (lost.length) out.textContent = `The fonts of the PDF lack ${lost.join(" ")}; the SVG shows them.`;
    };
    const scale = (state) => { state.log = state.log ? 0 : 1; state.zoom = null; redraw(); };
    [() => zoom(0.8), () => zoom(1.25), reset, () => scale(view), () => scale(own), svgFile, pngFile, pdfFile].forEach((act, i) => (tools[i].onclick = act));
    tools.slice(3, 5).forEach((b, i) => (b.hidden = p.e || !curves.some((m) => (i ? m.y : m.x).some((v) => v > 0))));
    [...el.querySelectorAll(".legend button")].forEach((b, i) => (b.onclick = () => {
      const n = names[i];
      if (!hidden.delete(n)) hidden.add(n);
      b.setAttribute("aria-pressed", !hidden.has(n));
      legend.panels.forEach((o) => o.draw());
    }));
    return own;
  }
}
document.querySelectorAll(".plot").forEach(figure);
