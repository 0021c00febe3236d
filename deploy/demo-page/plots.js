// Plots over the tour's time, drawn as SVG: stacked areas, lines, dots and bars that share one cursor.
"use strict";

const Plots = (() => {
  const NS = "http://www.w3.org/2000/svg";
  const WIDTH = 560, HEIGHT = 190, LEFT = 52, RIGHT = 10, TOP = 10, BOTTOM = 22;
  const COLOURS = 10;

  function svg(name, attributes = {}, parent = null) {
    const node = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (parent) parent.append(node);
    return node;
  }
  function html(name, className, text = "") {
    const node = document.createElement(name);
    if (className) node.className = className;
    node.textContent = text;
    return node;
  }
  const plain = (text) => text.replace(/\.0+(?=\D|$)/, "");  // 10.0 s is 10 s on an axis
  const colour = (index) => `var(--c${Math.min(index, COLOURS - 1)})`;

  // At most four round steps up to the end.
  function ticks(end) {
    if (!(end > 0)) return [0];
    const raw = end / 4, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 2.5, 5, 10].find((factor) => factor * power >= raw);
    const list = [];
    for (let value = 0; value <= end * 1.0001; value += step) list.push(value);
    return list;
  }

  // Single frames that tower over the rest (the first, which compiles shaders) are cut off, and the plot says so.
  function axisEnd(totals) {
    const sorted = totals.filter(Units.known).sort((a, b) => a - b);
    const usual = sorted[Math.floor((sorted.length - 1) * 0.95)] || sorted[sorted.length - 1] || 1;
    return 1.05 * sorted.filter((value) => value <= 2.5 * usual).pop();
  }

  // plot({title, note, unit, times, series: [{name, values, colour?}], kind: "stack" | "line" | "bars", seek})
  // A value of null is not drawn. Returns {element, show(index), mark(times)}.
  function plot({ title, note, unit, times, series, kind, seek }) {
    const element = html("figure", "plot");
    const head = html("figcaption");
    head.append(html("h3", "", title));
    if (note) head.append(html("p", "note", note));
    const canvas = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" });
    const legend = html("p", "legend");
    element.append(head, canvas, legend);

    const last = times[times.length - 1] || 1;
    const stacked = kind === "stack";
    const totals = times.map((_, i) => (stacked ? series.reduce((sum, s) => sum + (s.values[i] || 0), 0)
      : Math.max(...series.map((s) => (Units.known(s.values[i]) ? s.values[i] : 0)))));
    const end = axisEnd(totals);
    const x = (t) => LEFT + (t / last) * (WIDTH - LEFT - RIGHT);
    const y = (value) => HEIGHT - BOTTOM - (Math.min(value, end) / end) * (HEIGHT - TOP - BOTTOM);

    for (const value of ticks(end)) {
      svg("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y(value), y2: y(value) }, canvas);
      svg("text", { class: "tick", x: LEFT - 6, y: y(value) + 3.5, "text-anchor": "end" }, canvas).textContent = plain(unit(value));
    }
    for (const t of ticks(last)) {
      svg("text", { class: "tick", x: x(t), y: HEIGHT - 6, "text-anchor": "middle" }, canvas).textContent = plain(`${Units.figure(t)} s`);
    }
    const marks = svg("g", { class: "plot-marks" }, canvas);

    const ink = (s, i) => s.colour || colour(i);
    const draw = {
      stack() {
        let below = times.map(() => 0);
        series.forEach((s, i) => {
          const above = below.map((value, k) => value + (s.values[k] || 0));
          const upper = times.map((t, k) => `${x(t).toFixed(1)},${y(above[k]).toFixed(1)}`);
          const lower = times.map((t, k) => `${x(t).toFixed(1)},${y(below[k]).toFixed(1)}`).reverse();
          svg("polygon", { points: [...upper, ...lower].join(" "), style: `fill:${ink(s, i)}` }, canvas);
          below = above;
        });
      },
      line() {
        series.forEach((s, i) => {
          const points = times.map((t, k) => (Units.known(s.values[k]) ? [x(t), y(s.values[k])] : null)).filter(Boolean);
          if (s.dots) {
            for (const [cx, cy] of points) svg("circle", { class: "dot", cx, cy, r: 4, style: `fill:${ink(s, i)}` }, canvas);
          } else {
            svg("polyline", { class: "line", points: points.map((p) => p.map((v) => v.toFixed(1)).join()).join(" "),
              style: `stroke:${ink(s, i)}` }, canvas);
          }
        });
      },
      bars() {
        series.forEach((s, i) => s.values.forEach((value, k) => {
          if (value > 0) svg("line", { class: "stem", x1: x(times[k]), x2: x(times[k]), y1: y(0), y2: y(value), style: `stroke:${ink(s, i)}` }, canvas);
        }));
      },
    };
    draw[kind]();
    totals.forEach((value, k) => {
      if (value > end) {
        const cut = svg("path", { class: "cut", d: `M${x(times[k])} ${TOP - 8}l4 7h-8z` }, canvas);
        svg("title", {}, cut).textContent = `${unit(value)}, beyond the axis`;
      }
    });

    const hover = svg("line", { class: "hover", y1: TOP, y2: HEIGHT - BOTTOM, visibility: "hidden" }, canvas);
    const cursor = svg("line", { class: "cursor", y1: TOP - 4, y2: HEIGHT - BOTTOM }, canvas);

    const values = series.map((s, i) => {
      const item = html("span");
      const swatch = html("i");
      swatch.style.background = ink(s, i);
      const value = html("b");
      item.append(swatch, `${s.name} `, value);
      legend.append(item);
      return value;
    });
    const read = (k) => series.forEach((s, i) => { values[i].textContent = unit(s.values[k]); });

    let shown = 0;
    const nearest = (event) => {
      const box = canvas.getBoundingClientRect();
      const t = (((event.clientX - box.left) / box.width) * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT) * last;
      let best = 0;
      times.forEach((time, k) => { if (Math.abs(time - t) < Math.abs(times[best] - t)) best = k; });
      return best;
    };
    canvas.addEventListener("pointermove", (event) => {
      const k = nearest(event);
      hover.setAttribute("x1", x(times[k]));
      hover.setAttribute("x2", x(times[k]));
      hover.setAttribute("visibility", "visible");
      read(k);
      if (event.buttons) seek(k);
    });
    canvas.addEventListener("pointerleave", () => {
      hover.setAttribute("visibility", "hidden");
      read(shown);
    });
    canvas.addEventListener("pointerdown", (event) => seek(nearest(event)));

    const peak = Math.max(...totals);
    canvas.setAttribute("aria-label", `${title}: ${series.map((s) => s.name).join(", ")}; at most ${unit(peak)}`);
    return {
      element,
      show(k) {
        shown = k;
        cursor.setAttribute("x1", x(times[k]));
        cursor.setAttribute("x2", x(times[k]));
        read(k);
      },
      mark(list) {
        for (const t of list) svg("line", { class: "event", x1: x(t), x2: x(t), y1: TOP, y2: HEIGHT - BOTTOM }, marks);
      },
    };
  }

  return { plot, svg, html, colour };
})();
