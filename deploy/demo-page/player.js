// Plays the frames of a tour and shows what the server said about each of them. The data is data.js:
// window.HELIOGRAPH_TOUR is a telemetry.json of `helio view`, window.HELIOGRAPH_MADE says when and how it was made.
"use strict";

(() => {
  const { html, svg, colour } = Plots;
  const { figure, ms, bytes, count, seconds, words, known } = Units;
  const at = (id) => document.getElementById(id);
  const tour = window.HELIOGRAPH_TOUR;
  const made = window.HELIOGRAPH_MADE || {};
  if (!tour || !tour.frames || !tour.frames.length) {
    at("lead").textContent = "data.js beside this page holds no frames.";
    return;
  }
  const frames = tour.frames;
  const times = frames.map((frame) => frame.t - frames[0].t);
  const length = times[times.length - 1];
  const names = (part) => [...new Set(frames.flatMap((frame) => Object.keys(frame[part] || {})))];
  const sum = (part, name) => frames.reduce((total, frame) => total + ((frame[part] || {})[name] || 0), 0);
  // The costliest first: it gets the first colour everywhere.
  const ranked = (part) => names(part).sort((a, b) => sum(part, b) - sum(part, a)).filter((name) => sum(part, name) > 0);
  const passes = ranked("passes"), rays = ranked("rays"), memory = names("memory");
  const stages = names("stages").filter((name) => sum("stages", name) > 0);

  // ---- Events ----
  const KINDS = [
    { name: "jump", test: /^jump/i, shape: "M0-6 6 0 0 6-6 0z" },
    { name: "build", test: /^buil/i, shape: "M0-6 6 5H-6z" },
    { name: "destroy", test: /^destr/i, shape: "M0 6 6-5H-6z" },
    { name: "light", test: /sun|light/i, shape: "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z" },
    { name: "other", test: /./, shape: "M-4-4h8v8h-8z" },
  ];
  const kindOf = (text) => KINDS.find((kind) => kind.test.test(text));
  const events = frames.flatMap((frame, k) => (frame.events || []).map((text) => ({ k, text, kind: kindOf(text) })));

  // ---- Head ----
  const server = tour.server || {}, settings = tour.settings || {}, summary = tour.summary || {};
  at("lead").textContent = `The world “${tour.world}”, path-traced by ${server.device || "a server"} and streamed to a thin client that flew, jumped, built and destroyed.`;
  function pair(list, term, text) {
    if (text === undefined || text === null || text === "") return;
    const group = html("div");
    group.append(html("dt", "", term), html("dd", "", String(text)));
    list.append(group);
  }
  pair(at("settings"), "device", server.device);
  pair(at("settings"), "driver", server.driver);
  pair(at("settings"), "size", settings.width && `${settings.width} × ${settings.height}`);
  pair(at("settings"), "mode", settings.mode);
  pair(at("settings"), "primary hits", settings.primary);
  pair(at("settings"), "bounces", settings.bounces);
  pair(at("settings"), "paths a pixel", settings.samples);
  pair(at("settings"), "server", server.version);

  function figureCard(value, label, detail) {
    const card = html("div");
    card.append(html("strong", "", value), html("span", "", label), html("small", "", detail || ""));
    at("figures").append(card);
  }
  const spread = (times) => (times && known(times.median) ? `95 %: ${ms(times.p95)} · worst ${ms(times.max)}` : "not measured");
  const middle = (times) => ms(times ? times.median : null);
  figureCard(count(summary.frames ?? frames.length), "frames", `in ${figure(summary.seconds ?? length)} s, ${figure(summary.frames_per_second)} a second`);
  figureCard(middle(summary.gpu_ms), "on the device, a frame", spread(summary.gpu_ms));
  figureCard(middle(summary.motion_to_photon_ms), "from motion to picture", spread(summary.motion_to_photon_ms));
  figureCard(middle(summary.edit_to_picture_ms), "from edit to picture", spread(summary.edit_to_picture_ms));
  figureCard(count(summary.dropped ?? 0), "frames dropped", "replaced by newer ones");
  figureCard(bytes(summary.bytes), "received", `${bytes((summary.bytes ?? 0) / Math.max(summary.frames ?? frames.length, 1))} a frame`);

  // ---- Plots ----
  const stack = (part, list) => list.map((name) => ({ name: words(name), values: frames.map((frame) => (frame[part] || {})[name] ?? 0) }));
  const field = (name) => frames.map((frame) => frame[name] ?? null);
  const plots = [
    { title: "GPU time by pass", unit: ms, kind: "stack", series: stack("passes", passes) },
    { title: "Latency", unit: ms, kind: "line", note: "of the first frame that shows a camera or an edit",
      series: [{ name: "motion to picture", values: field("motion_to_photon_ms"), colour: "var(--c1)" },
        { name: "edit to picture", values: field("edit_to_picture_ms"), colour: "var(--c3)", dots: true }] },
    { title: "Rays by kind", unit: count, kind: "stack", note: "each frame", series: stack("rays", rays) },
    { title: "GPU memory by category", unit: bytes, kind: "stack", series: stack("memory", memory) },
    { title: "Dropped frames", unit: count, kind: "bars", note: "rendered, then replaced by a newer one before it was sent",
      series: [{ name: "dropped before this frame", values: field("dropped_before"), colour: "var(--c3)" }] },
    { title: "Bytes", unit: bytes, kind: "line", note: "each frame, as it was received",
      series: [{ name: "frame", values: field("bytes"), colour: "var(--c2)" }] },
  ].filter((p) => p.series.length).map((p) => Plots.plot({ ...p, times, seek: (k) => { pause(); show(k); } }));
  for (const plot of plots) {
    plot.mark(events.map((event) => times[event.k]));
    at("plots").append(plot.element);
  }

  // ---- The shown frame ----
  function bar(node, parts, total, label) {
    node.replaceChildren(...parts.filter((part) => part.value > 0).map((part) => {
      const piece = html("span");
      piece.style.flexGrow = part.value / (total || 1);
      piece.style.background = part.colour;
      piece.title = `${part.name}: ${ms(part.value)}`;
      return piece;
    }));
    node.setAttribute("aria-label", `${label}: ${parts.map((part) => `${part.name} ${ms(part.value)}`).join(", ")}`);
  }
  function rows(table, list) {
    table.tBodies[0].replaceChildren(...list.map((cells) => {
      const row = html("tr");
      cells.forEach((cell, i) => {
        const node = html(i ? "td" : "th");
        if (!i) node.scope = "row";
        node.append(...[cell].flat());
        row.append(node);
      });
      return row;
    }));
  }
  function swatch(ink) {
    const node = html("i");
    node.style.background = ink;
    return node;
  }
  const share = (value, total) => (!total ? "–" : value && value < total / 100 ? "< 1 %" : `${Math.round((100 * value) / total)} %`);
  const axes = (position) => (position || []).map((value) => value.toFixed(1)).join(", ");

  function describe(k) {
    const frame = frames[k];
    at("facts").replaceChildren();
    const fact = (term, text) => pair(at("facts"), term, text);
    fact("frame", `${k + 1} of ${frames.length}`);
    fact("tick", count(frame.tick));
    fact("edits applied", count(frame.applied_seq));
    fact("camera", frame.camera && `${axes(frame.camera.position)} m`);
    fact("paths a pixel", count(frame.accumulated));
    fact("instances in the TLAS", count(frame.tlas_instances));
    if (frame.triangles_drawn) fact("triangles drawn", count(frame.triangles_drawn));
    const traced = Object.values(frame.rays || {}).reduce((a, b) => a + b, 0);
    fact("rays", count(traced));
    if (frame.nonfinite) fact("samples not finite", count(frame.nonfinite));
    fact("size", bytes(frame.bytes));

    const times = passes.map((name, i) => ({ name: words(name), value: (frame.passes || {})[name] ?? 0, colour: colour(i) }));
    const total = times.reduce((all, part) => all + part.value, 0);
    bar(at("pass-bar"), times, total, "GPU time by pass");
    rows(at("passes"), [...times.map((part) => [[swatch(part.colour), part.name], figure(part.value), share(part.value, total)]),
      ["together", figure(total), ""]]);

    const parts = stages.map((name, i) => ({ name: words(name), value: (frame.stages || {})[name] ?? 0, colour: colour((i + 1) % 10) }));
    bar(at("stage-bar"), parts, parts.reduce((all, part) => all + part.value, 0), "From camera to picture");
    at("stages").replaceChildren(...parts.map((part) => {
      const item = html("span");
      item.append(swatch(part.colour), `${part.name} `, html("b", "", ms(part.value)));
      return item;
    }));
    rows(at("effects"), (frame.effects || []).map((effect) =>
      [words(effect.name), count(effect.instances), bytes(effect.memory_bytes), figure(effect.pass_ms)]));
  }

  // ---- Player ----
  let shown = 0, playing = null;
  const cache = frames.map(() => null);
  function load(k) {
    if (k < frames.length && !cache[k]) {
      cache[k] = new Image();
      cache[k].src = frames[k].file;
    }
  }
  const lastEvent = (k) => events.filter((event) => event.k <= k && times[k] - times[event.k] < 2.5).pop();

  function show(k) {
    shown = Math.max(0, Math.min(k, frames.length - 1));
    for (let ahead = 0; ahead < 12; ++ahead) load(shown + ahead);
    at("picture").src = frames[shown].file;
    at("picture").alt = `Frame ${shown + 1} of the tour`;
    const event = lastEvent(shown);
    if (at("caption").textContent !== (event ? event.text : "")) at("caption").textContent = event ? event.text : "";
    at("scrub").value = shown;
    at("scrub").setAttribute("aria-valuetext", `frame ${shown + 1} of ${frames.length}, ${seconds(times[shown])}`);
    at("clock").textContent = `${seconds(times[shown])} / ${seconds(length)}`;
    describe(shown);
    for (const plot of plots) plot.show(shown);
  }

  function pause() {
    if (playing) cancelAnimationFrame(playing.request);
    playing = null;
    at("play-icon").setAttribute("d", "M7 4v16l13-8z");
    at("play").setAttribute("aria-label", "Play");
  }
  function play() {
    if (shown === frames.length - 1) show(0);
    playing = { clock: times[shown], before: performance.now(), request: 0 };
    at("play-icon").setAttribute("d", "M6 4h4v16H6zM14 4h4v16h-4z");
    at("play").setAttribute("aria-label", "Pause");
    const step = (now) => {
      playing.clock += ((now - playing.before) / 1000) * Number(at("speed").value);
      playing.before = now;
      let k = shown;
      while (k + 1 < frames.length && times[k + 1] <= playing.clock) ++k;
      if (k !== shown) show(k);
      if (k === frames.length - 1) pause(); else playing.request = requestAnimationFrame(step);
    };
    playing.request = requestAnimationFrame(step);
  }
  const toggle = () => (playing ? pause() : play());
  const go = (k) => { pause(); show(k); };
  const nextEvent = () => go(events.find((event) => event.k > shown)?.k ?? frames.length - 1);
  const previousEvent = () => go(events.filter((event) => event.k < shown).pop()?.k ?? 0);
  function faster(by) {
    const select = at("speed");
    select.selectedIndex = Math.max(0, Math.min(select.options.length - 1, select.selectedIndex + by));
  }

  at("scrub").max = frames.length - 1;
  at("scrub").addEventListener("input", () => go(Number(at("scrub").value)));
  for (const [id, action] of [["first", () => go(0)], ["back", () => go(shown - 1)], ["play", toggle], ["forward", () => go(shown + 1)], ["event", nextEvent]]) {
    at(id).addEventListener("click", action);
  }
  const keys = { " ": toggle, ArrowLeft: () => go(shown - 1), ArrowRight: () => go(shown + 1), Home: () => go(0), End: () => go(frames.length - 1),
    ".": nextEvent, ",": previousEvent, "+": () => faster(1), "=": () => faster(1), "-": () => faster(-1) };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    if (event.target.tagName === "SELECT" || (event.target.tagName === "BUTTON" && event.key === " ")) return;
    event.preventDefault();
    keys[event.key]();
  });

  // The marks stand where the slider's thumb stands at their frame.
  const marks = at("marks");
  function drawMarks() {
    const width = marks.clientWidth || 800, thumb = 16;
    marks.setAttribute("viewBox", `0 0 ${width} 20`);
    marks.replaceChildren(...events.map((event) => {
      const x = thumb / 2 + (event.k / Math.max(frames.length - 1, 1)) * (width - thumb);
      const mark = svg("path", { class: `mark-${event.kind.name}`, d: event.kind.shape, transform: `translate(${x} 10)` });
      svg("title", {}, mark).textContent = `${seconds(times[event.k])} ${event.text}`;
      mark.addEventListener("click", () => go(event.k));
      return mark;
    }));
  }
  new ResizeObserver(drawMarks).observe(marks);
  for (const kind of KINDS.filter((kind) => events.some((event) => event.kind === kind))) {
    const item = html("span"), icon = svg("svg", { viewBox: "-8 -8 16 16", class: "icon" });
    svg("path", { class: `mark-${kind.name}`, d: kind.shape }, icon);
    item.append(icon, kind.name);
    at("legend-marks").append(item);
  }

  // ---- Edits ----
  const edits = tour.edits || [];
  at("edit-section").hidden = !edits.length;
  rows(at("edits"), edits.map((edit) => [seconds(Math.max(edit.t - frames[0].t, 0)), edit.label, count(edit.seq), ms(edit.edit_to_picture_ms)]));
  [...at("edits").tBodies[0].rows].forEach((row, i) => {
    const k = frames.findIndex((frame) => frame.id === edits[i].frame || frame.applied_seq >= edits[i].seq);
    if (k < 0) return;
    row.classList.add("link");
    row.addEventListener("click", () => { go(k); at("picture").scrollIntoView({ block: "center" }); });
  });

  at("made").textContent = [made.date && `Made on ${made.date}`, made.commit && `from commit ${made.commit}`, made.command && `by ${made.command}`]
    .filter(Boolean).join(" ");
  show(0);
  frames.forEach((_, k) => setTimeout(() => load(k), 300 + 4 * k));
})();
