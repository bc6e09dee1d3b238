"use strict";
// Components of the application's page; state and changes come and go by trame.
window.raceway_app = (function () {
  const COLOURS = ["#0b5fa5", "#a8480f"];
  const FIRST = ["load.axial", "excitation.speed_rpm", "kinematics.spin_speed_rpm", "excitation.unbalance", "excitation.force",
    "bearing.preload", "bearing.contact_angle_deg"];
  // Ends of sliders that begin at 0.
  const START = { "load.axial": 2000, "excitation.speed_rpm": 20000, "kinematics.spin_speed_rpm": 20000, "excitation.unbalance": 1e-3,
    "excitation.force": 1000, "bearing.preload": 1000, "bearing.contact_angle_deg": 40 };
  // Nouns of keys whose last word does not say what they are.
  const NOUNS = { "load.axial": "axial load", "load.radial": "radial load", "load.moment": "moment load", "excitation.speed_rpm": "speed", "bearing.preset": "designation",
    "supports.tilt": "tilt stiffness", "supports.axial": "axial support", "rotor.mass": "rotor mass", "rotor.damping": "rotor damping", "excitation.kind": "excitation model", "contact.kind": "contact law",
    "contact.damping": "contact damping", "excitation.force": "force amplitude", "excitation.amplitude": "law of the amplitude", "bearing.arrangement": "arrangement of rows", "bearing.row": "single row" };
  function noun(path) {
    const parts = path.split("."), words = (part) => part.replace(/_(rpm|deg|c)$/, "").replaceAll("_", " ");
    if (NOUNS[path]) return NOUNS[path];
    if (parts.at(-1) === "kind") return words(parts.at(-2));
    return parts.length > 2 ? words(parts.at(-2)) + ": " + words(parts.at(-1)) : words(parts.at(-1));
  }
  const signed = (v, digits = 3) => v === null || v === undefined ? "-" : (v > 0 ? "+" : "") + number(v, digits);
  const percent = ([low, high]) => Math.max(-low, high) < 5e-6 ? "0.0005 %" : signed(100 * low, 2) + " to " + signed(100 * high, 2) + " %";
  // Quantities whose interval is that of another, relative.
  const INTERVALS = { l10r_hours: "l10r_million_revolutions" };
  const interval = (screen, name) => screen?.intervals[INTERVALS[name] ?? name]?.relative ?? null;
  // Keys by which the scenes differ, and whether they are of one bearing.
  function differing(panels) {
    const [a, b] = panels.map((p) => p.said);
    return [...new Set([...Object.keys(a), ...Object.keys(b)])].filter((key) => key !== "title" && a[key] !== b[key]);
  }
  const ofMounting = /^bearing\.(arrangement|preload|preload_kind|preload_of|second_preload|row_distance)$/;
  const sameBearing = (panels) => differing(panels).every((key) => !key.startsWith("bearing.") || ofMounting.test(key));
  // Interval of the ratio of a quantity of two scenes, relative: numerical errors of both add as squares, as data of two bearings do;
  // of other causes the difference counts, since what changes both by the same factor leaves the ratio.
  function apart(screens, name, same) {
    const [a, b] = screens.map((screen) => screen?.intervals[INTERVALS[name] ?? name]?.parts);
    if (!a || !b) return null;
    const known = [], signed = [0, 0];
    for (const [cause, first] of Object.entries(a)) {
      const second = b[cause], ends = (part) => [Math.min(0, part.low), Math.max(0, part.high)];
      if (!second || first.low === null || second.low === null) continue;
      const [p, q] = [ends(first), ends(second)], alone = cause === "numerical" || (cause === "data" && !same);
      const two = alone ? [-Math.hypot(q[0], p[1]), Math.hypot(q[1], p[0])] : [q[0] - p[0], q[1] - p[1]];
      const [low, high] = [Math.min(0, ...two), Math.max(0, ...two)];
      if (["hypotheses", "contact", "bodies"].includes(cause)) { signed[0] += low; signed[1] += high; } else known.push([low, high]);
    }
    return [0, 1].map((side) => (side ? 1 : -1) * Math.hypot(...[signed, ...known].map((ends) => ends[side])));
  }
  const number = (v, digits = 4) => v === null || v === undefined ? "-" : String(Number(v.toPrecision(digits)));

  // 1, 2 or 5 times a power of ten, some `count` of them from low to high.
  function ticks(low, high, count) {
    const raw = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].find((f) => f * power >= raw) * power, out = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) out.push(k * step);
    return out;
  }

  // Values of a curve at x, between its points; null where either has none.
  function between(series, x) {
    const k = series.x.findIndex((v) => v >= x), [x0, x1, y0, y1] = [series.x[k - 1], series.x[k], series.y[k - 1], series.y[k]];
    if (k < 0 || y1 === null || x1 === x) return k < 0 ? null : y1;
    return k === 0 || y0 === null ? null : y0 + (y1 - y0) * (x - x0) / (x1 - x0);
  }

  // K of the present point of curves, in the unit that it is read in.
  function ofCurves(curves) {
    for (const p of curves ?? []) {
      const line = p.lines.find((l) => l.name === "equivalent_stiffness"), k = line ? p.x.indexOf(p.present) : -1;
      if (k >= 0) return line.y[k];
    }
    return null;
  }

  const LEFT = 48, RIGHT = 300, WIDTH = 320;
  const Chart = {
    props: ["chart", "names", "screens", "one"],
    data: () => ({ at: null }),
    computed: {
      // Curves of the second scene less those of the first: in per cent, temperatures in degrees.
      differences() {
        const [first, second] = [0, 1].map((k) => this.chart.series.filter((s) => s.panel === k));
        return first.flatMap((a) => {
          const b = second.find((s) => s.label === a.label);
          if (!b) return [];
          const y = a.x.map((x, i) => {
            const [va, vb] = [a.y[i], between(b, x)];
            if (va === null || vb === null) return null;
            return this.relative ? (va === 0 ? null : 100 * (vb - va) / Math.abs(va)) : vb - va;
          });
          return y.some((v) => v !== null) ? [{ x: a.x, y, present: a.present }] : [];
        });
      },
      relative() { return this.chart.unit !== "°C"; },
      interval() { return interval(this.screens[0], this.chart.series[0].name); },
      frame() {
        const xs = this.chart.series.flatMap((s) => s.x), ys = this.chart.series.flatMap((s) => s.y).filter((y) => y !== null), two = this.differences.length > 0;
        let [x0, x1] = [Math.min(...xs), Math.max(...xs)], [y0, y1] = ys.length ? [Math.min(...ys), Math.max(...ys)] : [0, 1];
        if (this.band) { y0 *= 1 + this.interval[0]; y1 *= 1 + this.interval[1]; }
        if (!two && y0 > 0 && y0 < 0.6 * y1) y0 = 0;
        if (y1 - y0 < 1e-3 * Math.abs(y1) || y1 === y0) { const pad = 0.02 * Math.abs(y1) || 1; y0 -= pad; y1 += pad; }
        y1 += 0.06 * (y1 - y0);
        const ds = this.edges.flat().flat().map((p) => p[1]).concat(this.differences.flatMap((d) => d.y).filter((y) => y !== null));
        let [d0, d1] = [Math.min(0, ...ds), Math.max(0, ...ds)];
        if (d1 - d0 < 1e-4) { d0 -= 0.01; d1 += 0.01; }
        const pad = 0.12 * (d1 - d0), bottom = two ? 128 : 150;
        return { x0, x1, y0, y1, d0: d0 - pad, d1: d1 + pad, bottom, end: two ? 212 : 150, two,
          x: (v) => LEFT + (RIGHT - LEFT) * (v - x0) / (x1 - x0 || 1), y: (v) => bottom - (bottom - 8) * (v - y0) / (y1 - y0),
          d: (v) => 212 - 62 * (v - d0 + pad) / (d1 - d0 + 2 * pad) };
      },
      // One scene with positive values: the interval of its quantity around the curve.
      band() { return !this.differences.length && this.chart.series.length === 1 && this.interval && this.chart.series[0].y.every((y) => y === null || y > 0); },
      area() {
        const f = this.frame, s = this.chart.series[0], points = s.x.map((x, i) => [x, s.y[i]]).filter((p) => p[1] !== null);
        const edge = (part, factor) => part.map(([x, y]) => f.x(x).toFixed(1) + " " + f.y(y * factor).toFixed(1)).join("L");
        return points.length ? "M" + edge(points, 1 + this.interval[0]) + "L" + edge([...points].reverse(), 1 + this.interval[1]) + "Z" : "";
      },
      own() { return this.relative && this.differences.length ? apart(this.screens, this.chart.series[0].name, this.one) : null; },
      // Both edges of the difference's interval, between gaps: lists of points.
      edges() {
        return !this.own ? [] : this.own.map((end) => {
          const pieces = [[]], d = this.differences[0];
          d.x.forEach((x, i) => d.y[i] === null ? pieces.push([]) : pieces.at(-1).push([x, d.y[i] + end * (100 + d.y[i])]));
          return pieces.filter((piece) => piece.length);
        });
      },
      shade() {
        const f = this.frame, words = (piece) => piece.map(([x, y]) => f.x(x).toFixed(1) + " " + f.d(y).toFixed(1)).join("L");
        return this.edges.length ? this.edges[0].map((piece, k) => "M" + words(piece) + "L" + words([...this.edges[1][k]].reverse()) + "Z").join("") : "";
      },
      lines() {
        const f = this.frame, seen = {};
        return this.chart.series.map((s) => {
          const k = s.x.indexOf(s.present), nth = seen[s.panel] = (seen[s.panel] ?? -1) + 1;
          const dot = k >= 0 && s.y[k] !== null ? { x: f.x(s.present), y: f.y(s.y[k]), value: s.y[k] } : null;
          return { path: this.path(s, f.y), dot, colour: COLOURS[s.panel], dash: s.panel ? "7 3" : nth ? "2 3" : "", name: this.names[s.panel] + ": " + s.label };
        });
      },
      same() { return new Set(this.chart.series.map((s) => s.label)).size === 1; },
      title() { return (this.same ? this.chart.series[0].label : this.chart.panel) + (this.chart.unit && this.chart.unit !== "1" ? " [" + this.chart.unit + "]" : ""); },
      xs() { return ticks(this.frame.x0, this.frame.x1, 5); },
      ys() { return ticks(this.frame.y0, this.frame.y1, 4); },
      ds() { return ticks(this.frame.d0, this.frame.d1, 3); },
      place() { return this.at ?? this.chart.series[0].present; },
      label() {
        const now = this.lines.filter((l) => l.dot).map((l) => l.name + " " + number(l.dot.value) + " " + this.chart.unit);
        return this.chart.panel + " over " + this.chart.label + "; " + (now.join(", ") || "no answer at the present point") + (this.difference ? "; " + this.difference : "");
      },
      difference() {
        const d = this.differences[0], v = d ? between(d, this.place) : null;
        return v === null ? "" : "B - A " + signed(v) + (this.relative ? " %" : " °C");
      },
      reading() {
        return this.chart.series.map((s, k) => {
          const value = this.at === null ? this.lines[k].dot?.value : between(s, this.at);
          return { colour: COLOURS[s.panel], text: this.names[s.panel] + (this.same ? " " : " " + s.label + " ") + number(value) };
        });
      },
    },
    methods: {
      number, percent,
      path(series, y) {
        let path = "", pen = "M";
        series.x.forEach((x, i) => {  // a gap where there is no answer
          if (series.y[i] === null) { pen = "M"; return; }
          path += pen + this.frame.x(x).toFixed(1) + " " + y(series.y[i]).toFixed(1);
          pen = "L";
        });
        return path;
      },
      move(event) {
        const box = this.$refs.svg.getBoundingClientRect(), x = (event.clientX - box.left) * WIDTH / box.width, f = this.frame;
        this.at = x < LEFT || x > RIGHT ? null : f.x0 + (x - LEFT) / (RIGHT - LEFT) * (f.x1 - f.x0);
      },
    },
    template: `<figure class="chart" :data-test="'chart-' + chart.axis + '-' + chart.panel">
      <figcaption><b>{{ title }}</b><br><span v-for="r in reading" class="reading" :style="{ color: r.colour }">{{ r.text }}</span>
        <span class="difference" v-if="difference">{{ difference }}</span><span v-if="at !== null"> at {{ number(at, 4) }}</span></figcaption>
      <svg ref="svg" :viewBox="'0 0 320 ' + (frame.end + 36)" role="img" :aria-label="label" @pointermove="move" @pointerleave="at = null">
        <path v-if="band" class="band" :d="area"/><path v-if="frame.two && shade" class="band edged" :d="shade"/>
        <path v-for="x in xs" class="rule" :d="'M' + frame.x(x) + ' 8V' + frame.bottom + (frame.two ? 'M' + frame.x(x) + ' 150V212' : '')"/>
        <path v-for="y in ys" class="rule" :d="'M48 ' + frame.y(y) + 'H300'"/>
        <text v-for="x in xs" :x="frame.x(x)" :y="frame.end + 14" text-anchor="middle">{{ number(x) }}</text>
        <text v-for="y in ys" x="44" :y="frame.y(y) + 4" text-anchor="end">{{ number(y) }}</text>
        <text x="174" :y="frame.end + 30" text-anchor="middle">{{ chart.label }}</text>
        <path v-if="at !== null" class="rule" :d="'M' + frame.x(at) + ' 8V' + frame.end"/>
        <g v-for="l in lines"><path class="line" :d="l.path" :stroke="l.colour" :stroke-dasharray="l.dash"/>
          <circle v-if="l.dot" :cx="l.dot.x" :cy="l.dot.y" r="4.5" :fill="l.colour"/></g>
        <g v-if="frame.two"><text x="48" y="145">B - A [{{ relative ? '%' : '°C' }}]{{ shade ? ', one alone: ' + percent(own) : '' }}</text>
          <path v-for="d in ds" class="rule" :d="'M48 ' + frame.d(d) + 'H300'"/><text v-for="d in ds" x="44" :y="frame.d(d) + 4" text-anchor="end">{{ number(d) }}</text>
          <path v-for="d in differences" class="line inner" :d="path(d, frame.d)"/></g>
      </svg></figure>`,
  };

  // One line of curves, which the reader chooses; a cookie remembers them, since each start has a port, and so a storage, of its own.
  const Curves = {
    props: ["curves", "screens", "busy", "one"], emits: ["range", "set"],
    data: () => ({ chosen: (/(?:^|; )raceway_curves=([^;]*)/.exec(document.cookie)?.[1] ?? "speed.stiffness,speed.ball load,load.stiffness").split(",").map(decodeURIComponent) }),
    computed: {
      names() { return this.curves.map((_, k) => "AB"[k]); },
      charts() {  // curves of the same quantity of both scenes in one
        const charts = new Map();
        this.curves.forEach((panels, panel) => (panels ?? []).forEach((p) => {
          const key = p.axis + "." + p.panel, { axis, label, unit, missing, why } = p;
          if (!charts.has(key)) charts.set(key, { axis, panel: p.panel, label, unit, series: [], notes: [] });
          // A micrometre's millionth is the noise of the solution.
          const still = (y) => y !== null && unit === "µm" && Math.abs(y) < 1e-6 ? 0 : y;
          charts.get(key).series.push(...p.lines.map((line) => ({ panel, name: line.name, label: line.label, x: p.x, y: line.y.map(still), present: p.present })));
          if (why || missing.length) charts.get(key).notes.push({ panel, axis, label, missing, why, key: p.key, moves: !!this.screens[panel]?.intervals.equivalent_stiffness });
        }));
        return [...charts.values()];
      },
      full() { return this.charts.filter((c) => c.series.some((s) => s.y.some((y) => y !== null))); },
      shown() { return this.full.filter((c) => this.chosen.includes(this.id(c))); },
      axes() {
        const axes = {};
        for (const c of this.charts) if (c.series.length) axes[c.axis] ??= { name: c.axis, label: c.label, low: c.series[0].x[0], high: c.series[0].x.at(-1) };
        return Object.values(axes);
      },
      // What the curves leave out, once for all of an axis.
      notes() {
        const notes = new Map();
        for (const n of this.charts.flatMap((c) => c.notes)) notes.set(n.panel + n.axis + n.why, n);
        return [...notes.values()].map((n) => {
          const [low, high] = [n.missing[0], n.missing.at(-1)].map((x) => number(x, 5)), where = this.bare(n.label);
          const words = n.missing.length ? where + " " + (low === high ? low : low + " to " + high) + " " + this.unit(n.label) + ": " + (n.why
            || (n.moves ? "no steady orbit grows from rest with the force there, or balls carry nothing" : "no equilibrium: the balls carry nothing")) : n.why;
          return { ...n, words: this.names[n.panel] + ": " + words };
        });
      },
    },
    methods: {
      number,
      id: (c) => c.axis + "." + c.panel,
      bare: (label) => label.split(" [")[0],
      unit: (label) => label.split("[")[1]?.replace("]", "") ?? "",
      choose(c) {
        const id = this.id(c);
        this.chosen = this.chosen.includes(id) ? this.chosen.filter((other) => other !== id) : [...this.chosen, id];
        document.cookie = "raceway_curves=" + this.chosen.map(encodeURIComponent).join(",") + "; max-age=31536000; path=/; SameSite=Strict";
      },
      send(axis, field, end) {  // what is refused does not stay
        const ends = { ...axis, [end]: field.value === "" ? null : +field.value };
        field.value = axis[end];
        this.$emit("range", axis.name, ends.low, ends.high);
      },
    },
    template: `<div class="choice"><div class="chips" v-for="a in axes" :key="a.name"><h2>Over {{ bare(a.label) }}</h2>
        <button type="button" v-for="c in full.filter((c) => c.axis === a.name)" :key="c.panel" :aria-pressed="chosen.includes(id(c))" :data-curve="id(c)" @click="choose(c)">{{ c.panel }}</button></div></div>
      <p class="small" v-if="!charts.length && !Object.keys(busy).length">no curves: the scene has neither a speed nor an axial load, or is refused</p>
      <div class="grid"><raceway-chart v-for="c in shown" :key="id(c)" :chart="c" :names="names" :screens="screens" :one="one"></raceway-chart></div>
      <p class="small" v-for="n in notes">{{ n.words }} <button type="button" v-if="n.missing.length" @click="$emit('set', [n.panel], n.key, String(n.missing[0]))">Run {{ number(n.missing[0], 5) }} {{ unit(n.label) }} to see why</button></p>
      <p class="small ranges"><span v-for="a in axes" :key="a.name">{{ bare(a.label) }} from <input type="number" :aria-label="a.label + ', from'" :value="a.low" @change="send(a, $event.target, 'low')"> to
        <input type="number" :aria-label="a.label + ', to'" :value="a.high" @change="send(a, $event.target, 'high')"> {{ unit(a.label) }}&emsp;</span></p>`,
  };

  // The first number of a screen, with its interval and the point that it holds at.
  const Answer = {
    props: ["screen", "curves", "fresh", "name"],
    computed: {
      row() { return this.screen?.rows.find((r) => r[1]); },
      value() {  // of the curves until the scene is run
        const [, digits, unit] = /^([\d.]+) (\D+)$/.exec(this.row[1]) ?? [], now = this.fresh && this.row[0].startsWith("equivalent stiffness") ? ofCurves(this.curves) : null;
        return now === null || !unit ? this.row[1] : number(now, digits.replace(/^0?\.0*|\./, "").length) + " " + unit;
      },
      range() { const i = this.screen.intervals.equivalent_stiffness ?? this.screen.intervals.kyy; return i?.relative && this.row[0].includes("stiffness") ? [i.low, i.high].map((v) => number(v * 1e-6, 3)).join(" to ") : ""; },
      where() { return this.screen?.rows.find((r) => !r[1] && !r[2])?.[0].replace(/^Answer /, "") ?? ""; },
    },
    template: `<div class="answer" v-if="row" :data-test="'answer-' + name"><strong>{{ value }}</strong>{{ range }} <span v-if="row[2]">({{ row[2] }})</span>
      <span class="small">{{ row[0] }} {{ where }}</span><details class="warning" v-if="screen.warnings.length"><summary>{{ screen.warnings.length }} {{ screen.warnings.length > 1 ? 'warnings' : 'warning' }}: {{ screen.warnings[0] }}</summary>
      <p class="small" v-for="w in screen.warnings.slice(1)">{{ w }}</p></details></div>`,
  };

  // The second scene against the first, in a sentence.
  const Verdict = {
    props: ["panels", "screens", "curves", "fresh"],
    computed: {
      keys() { return differing(this.panels); },
      words() {
        const said = (p, key) => p.said[key] ?? p.holds[key] ?? "default";
        if (!this.keys.length) return "B is A: change a key of one of them";
        const differs = this.keys.length === 1 && this.keys[0].endsWith(".kind");
        const names = differs ? this.panels.toReversed().map((p) => said(p, this.keys[0])).join(" against ") : "B against A (" + this.keys.map((key) => noun(key) + " " + said(this.panels[1], key) + " for " + said(this.panels[0], key)).join(", ") + ")";
        const [a, b] = this.screens.map((s) => s?.intervals.equivalent_stiffness ?? s?.intervals.kyy);
        if (!a?.relative || !b?.relative) return names;
        const now = this.fresh ? this.curves.map(ofCurves) : [null, null], change = now[0] && now[1] ? now[1] / now[0] - 1 : b.value / a.value - 1;
        const inside = [a.relative[0] <= change && change <= a.relative[1], b.relative[0] <= -change / (1 + change) && -change / (1 + change) <= b.relative[1]];
        const both = inside[0] === inside[1] ? (inside[0] ? "within the interval of both" : "outside the interval of both") : "within the interval of " + "AB"[inside[0] ? 0 : 1] + " alone";
        const own = apart(this.screens, a === this.screens[0].intervals.equivalent_stiffness ? "equivalent_stiffness" : "kyy", sameBearing(this.panels));
        return names + ": K " + signed(100 * change) + " %, " + both + " (A: " + percent(a.relative) + "); difference within " + percent(own) + " by causes of one alone; of common ones (geometry, hypotheses) not estimated";
      },
    },
    template: `<p class="verdict" data-test="verdict">{{ words }}</p>`,
  };

  const Polar = {
    props: ["balls"],
    computed: {
      top() { return Math.max(1e-12, ...this.balls.flatMap((b) => [b[1], b[2]])); },
      bars() {
        return this.balls.map((b, k) => {
          const a = b[0] * Math.PI / 180, twins = this.balls.flatMap((c, i) => Math.abs(c[0] - b[0]) < 1e-6 ? [i] : []);  // of rows at the same azimuth, beside each other
          const aside = (twins.indexOf(k) - (twins.length - 1) / 2) * 8, reach = (q) => 18 + 40 * q / this.top;
          const at = (r, s = aside) => [90 + r * Math.cos(a) + s * Math.sin(a), 84 - r * Math.sin(a) + s * Math.cos(a)];
          return { outer: [at(18), at(reach(b[2]))], inner: [at(18), at(reach(b[1]))], name: at(72, 0), label: twins.join(","), alone: twins[0] === k, thin: twins.length > 1, text: k + ": " + number(b[1]) + " N inner, " + number(b[2]) + " N outer" };
        });
      },
    },
    methods: { number },
    template: `<figure><svg viewBox="0 0 180 168" role="img" :aria-label="'Ball loads round the bearing: ' + bars.map((b) => b.text).join('; ')">
      <circle class="rule" cx="90" cy="84" r="18"/><circle class="rule" cx="90" cy="84" r="58"/>
      <g v-for="b in bars"><title>{{ b.text }}</title>
        <line class="outer" :class="{ thin: b.thin }" :x1="b.outer[0][0]" :y1="b.outer[0][1]" :x2="b.outer[1][0]" :y2="b.outer[1][1]"/>
        <line class="inner" :class="{ thin: b.thin }" :x1="b.inner[0][0]" :y1="b.inner[0][1]" :x2="b.inner[1][0]" :y2="b.inner[1][1]"/>
        <text v-if="b.alone" :x="b.name[0]" :y="b.name[1] + 4" text-anchor="middle">{{ b.label }}</text></g></svg>
      <figcaption>ball loads at rest, circle {{ number(top) }} N; inner (dark), outer</figcaption></figure>`,
  };

  const Orbit = {
    props: ["path"],
    computed: {
      middle() { const n = this.path.length; return [0, 1].map((i) => this.path.reduce((sum, p) => sum + p[i], 0) / n); },
      reach() { return Math.max(1e-12, ...this.path.map((p) => Math.hypot(p[0] - this.middle[0], p[1] - this.middle[1]))); },
      line() { return "M" + this.path.map((p) => (90 + 60 * (p[0] - this.middle[0]) / this.reach).toFixed(2) + " " + (84 - 60 * (p[1] - this.middle[1]) / this.reach).toFixed(2)).join("L"); },
    },
    methods: { number },
    template: `<figure v-if="path"><svg viewBox="0 0 180 168" role="img" :aria-label="'Orbit, largest distance from its middle ' + number(reach) + ' micrometres'">
      <path class="rule" d="M24 84H156M90 18V150"/><circle class="rule" cx="90" cy="84" r="60"/><path class="line inner" :d="line"/>
      <text x="164" y="88">y</text><text x="86" y="12">z</text></svg>
      <figcaption>orbit, circle {{ number(reach) }} µm</figcaption></figure>`,
  };

  const Bearing = {
    props: ["bodies", "rings", "name"],
    data: () => ({ outer: true, inner: true, none: "" }),
    watch: { bodies() { this.show(); }, outer() { this.drawing?.redraw(); }, inner() { this.drawing?.redraw(); } },
    mounted() { this.show(); },
    methods: {
      show() {
        if (!this.bodies || this.bodies.why || !this.rings) return;
        const state = JSON.parse(this.bodies.bodies), news = this.seen === this.rings.number ? state : { ...JSON.parse(this.rings.rings), ...state };
        this.seen = this.rings.number;
        if (this.drawing) this.drawing.update(news);
        else {
          this.drawing = raceway_stage(this.$refs.stage, this.$refs.words, (ring) => this[ring], news);
          if (!this.drawing) this.none = "This browser has no WebGL: the tables and curves have the same numbers.";
        }
        this.$refs.bars.innerHTML = state.bars.join("");  // made by the server from numbers alone
      },
    },
    template: `<div v-show="bodies && !bodies.why && !none"><div class="stage" ref="stage"><canvas role="img" :aria-label="'Bearing ' + name + ' in three dimensions'"></canvas></div>
      <div class="hint"><p class="small" ref="words">Drag, zoom, or point at a ball for its numbers.</p>
      <span>rings: <label><input type="checkbox" v-model="outer"> outer</label> <label><input type="checkbox" v-model="inner"> inner</label></span></div>
      <div class="bars" ref="bars"></div></div><p class="small" v-if="none || bodies?.why">{{ none || bodies.why }}</p>`,
  };

  const Numbers = {
    props: ["screens", "busy"],
    computed: {
      rows() {
        const rows = new Map();
        this.screens.forEach((screen, panel) => {
          let section = "", nth = {};
          for (const [name, value, remark] of screen?.rows ?? []) {
            if (!value && name) { section = name.replace(/ (at|under) .*/, ""); nth = {}; }
            const again = nth[name] = (nth[name] ?? -1) + 1, key = [section, value ? name : name ? "heading" : "remark", again].join("|");
            if (!rows.has(key)) rows.set(key, { name, heading: !value && !!name, remark: !value && !name, cells: {} });
            rows.get(key).cells[panel] = { name, value, remark };
          }
        });
        return [...rows.values()];
      },
    },
    methods: {
      both(row, part) {  // what two scenes state alike, once
        const words = Object.entries(row.cells).map(([k, c]) => ["AB"[k], c[part]]).filter((w) => w[1]);
        return new Set(words.map((w) => w[1])).size < 2 ? words[0]?.[1] ?? "" : words.map((w) => w.join(": ")).join("; ");
      },
    },
    template: `<div class="scroll" tabindex="0" role="region" aria-label="Numbers"><table data-test="numbers"><thead><tr><th scope="col">quantity</th>
        <th v-for="(s, k) in screens" scope="col" class="number" :data-number="s?.number">{{ 'AB'[k] }}</th><th scope="col" v-if="screens.length < 2">remark</th></tr></thead>
      <tbody><tr v-for="r in rows" :class="{ heading: r.heading }"><th scope="row" :colspan="r.heading || r.remark ? screens.length + (screens.length > 1 ? 1 : 2) : 1">{{ r.heading ? both(r, "name") : r.name }}<span class="small" v-if="screens.length > 1 || r.remark">{{ both(r, "remark") }}</span></th>
        <template v-if="!r.heading && !r.remark"><td v-for="(s, k) in screens" class="number" :class="{ stale: busy[k] }" :data-test="'value-' + k" :data-name="r.name">{{ r.cells[k]?.value ?? '' }}</td></template>
        <td class="small" v-if="screens.length < 2 && !r.heading && !r.remark">{{ both(r, "remark") }}</td></tr></tbody></table></div>
      <p class="small" v-for="(s, k) in screens"><template v-if="s">{{ 'AB'[k] }}: {{ s.bearing.split('\\n').slice(1).join('; ') }}; {{ s.left_out }}</template></p>`,
  };

  // A bearing by its number in the catalogue, or any maker's designation.
  const Designation = {
    props: ["value", "designations", "fault"], emits: ["set"],
    template: `<div class="field"><label for="designation">designation <small class="key">bearing.preset</small></label>
      <input type="text" id="designation" list="designations" :value="value" placeholder="7206C, 7014 CD/P4A, 6205-2RS" autocomplete="off" spellcheck="false" :aria-invalid="!!fault" @change="$emit('set', $event.target.value)">
      <datalist id="designations"><option v-for="d in designations" :value="d[0]">{{ d[1] }}</option></datalist><span class="fault" v-if="fault" role="alert">{{ fault }}</span></div>`,
  };

  const Form = {
    props: ["panels", "forms", "waiting", "designations"], emits: ["set"],
    data: () => ({ search: "", target: "both", open: {} }),
    computed: {
      two() { return this.panels.length > 1; },
      form() { return this.forms[this.chosen[0]] ?? this.forms[0]; },
      faults() {  // of the scenes that changes apply to
        const out = {};
        for (const k of this.chosen) for (const [path, words] of this.panels[k]?.mistakes ?? []) if (path) out[path] = (this.two ? "AB"[k] + ": " : "") + words;
        return out;
      },
      chosen() { return !this.two || this.target === "A" ? [0] : this.target === "B" ? [1] : [0, 1]; },
      first() {
        const fields = this.form.flatMap((g) => g.fields);
        return FIRST.map((path) => fields.find((f) => f.path === path)).filter((f) => f && isFinite(parseFloat(this.holds(f.path))));
      },
      groups() {
        const words = this.search.toLowerCase().split(/\s+/).filter(Boolean);
        const fits = (f) => words.every((w) => (noun(f.path) + " " + f.path + " " + f.help + " " + f.unit).toLowerCase().includes(w));
        return this.form.map((g) => ({ name: g.name, fields: g.fields.filter(fits) })).filter((g) => g.fields.length);
      },
    },
    methods: {
      noun,
      panel() { return this.panels[this.chosen[0]] ?? this.panels[0]; },
      said(path) { return this.panel().said[path] ?? ""; },
      holds(path) { return this.said(path) || (this.panel().holds[path] ?? ""); },
      other(path) {
        if (!this.two) return "";
        const [a, b] = this.panels.map((p) => p.said[path] ?? p.holds[path] ?? "");
        return a === b ? "" : "A: " + (a || "default") + ", B: " + (b || "default");
      },
      set(path, text, merge = false) { this.$emit("set", this.chosen, path, text, merge); },
      drag(field, text) {  // the newest place once the page shows the last one
        this.next = [field.path, text];
        if (this.timer) return;
        const send = () => {
          const waits = this.waiting && performance.now() - this.sent < 400;
          if (!this.next) { this.timer = null; return; }
          if (!waits) {
            const [path, value] = this.next;
            this.next = null;
            this.sent = performance.now();
            this.set(path, value, this.dragged === path);
            this.dragged = path;
          }
          this.timer = setTimeout(send, 30);
        };
        send();
      },
      top(field) {
        this.ends ??= {};
        const value = Math.abs(parseFloat(this.holds(field.path))), known = this.ends[field.path];
        if (!known || value > known || (value && value < 0.05 * known)) this.ends[field.path] = 2 * value || START[field.path] || 1;
        return this.ends[field.path];
      },
      options(f) { return [...new Set(["", ...(f.choices ?? []), this.said(f.path)])]; },
    },
    template: `<div class="form"><label class="search">Search all settings <input type="search" v-model="search"></label>
      <fieldset v-if="two"><legend>changes apply to</legend><label v-for="t in ['both', 'A', 'B']"><input type="radio" name="target" :value="t" v-model="target"> {{ t }}</label></fieldset>
      <fieldset class="first" v-show="!search"><legend>most used</legend><raceway-designation :value="said('bearing.preset')" :designations="designations" :fault="faults['bearing.preset']" @set="(text) => set('bearing.preset', text)"></raceway-designation><div v-for="f in first" :key="f.path" class="slider"><label :for="'s-' + f.path">{{ noun(f.path) }} <small class="key">{{ f.path }}</small><output>{{ holds(f.path) }} {{ f.unit }}</output></label>
        <input type="range" :id="'s-' + f.path" :data-slider="f.path" :min="parseFloat(holds(f.path)) < 0 ? -top(f) : 0" :max="top(f)" :step="top(f) / 200" :value="parseFloat(holds(f.path))"
          @input="drag(f, $event.target.value)" @change="dragged = null"></div></fieldset>
      <details v-for="g in groups" :key="g.name" :open="!!search || open[g.name]" @toggle="open[g.name] = $event.target.open">
        <summary>{{ g.name }}<span class="fault" v-if="g.fields.some((f) => faults[f.path])"> refused</span></summary>
        <template v-if="open[g.name] || search"><div v-for="f in g.fields" :key="f.path" class="field">
          <label :for="'f-' + f.path">{{ noun(f.path) }} <small v-if="f.unit">[{{ f.unit }}]</small><small class="key">{{ f.path }}</small></label>
          <select v-if="f.choices" :id="'f-' + f.path" :data-field="f.path" :value="said(f.path)" :aria-invalid="!!faults[f.path]" :aria-describedby="'h-' + f.path" @change="set(f.path, $event.target.value)">
            <option v-for="o in options(f)" :value="o">{{ o || 'default' + (holds(f.path) ? ': ' + holds(f.path) : '') }}</option></select>
          <template v-else><input type="text" :id="'f-' + f.path" :data-field="f.path" :value="said(f.path)" :placeholder="panel().holds[f.path] || f.default" autocomplete="off" spellcheck="false"
            :list="f.hints.length ? 'l-' + f.path : null" :aria-invalid="!!faults[f.path]" :aria-describedby="'h-' + f.path" @change="set(f.path, $event.target.value)">
          <datalist v-if="f.hints.length" :id="'l-' + f.path"><option v-for="o in f.hints" :value="o"></option></datalist></template>
          <span class="small" :id="'h-' + f.path">{{ f.help }}<template v-if="!said(f.path)"> (at its default)</template></span>
          <span class="fault" v-if="faults[f.path]" role="alert" :data-fault="f.path">{{ faults[f.path] }}</span>
          <span class="differs" v-if="other(f.path)">{{ other(f.path) }}</span></div>
          <button type="button" v-if="!search && g.fields.some((f) => said(f.path)) && g.name !== 'bearing'" @click="set(g.name, '')">Take table out</button></template></details></div>`,
  };

  const Copy = {
    props: ["text", "label", "without"],
    data: () => ({ done: false }),
    methods: { copy() { navigator.clipboard.writeText(this.text).then(() => { this.done = true; setTimeout(() => { this.done = false; }, 1500); }); } },
    template: `<button type="button" :disabled="!text" :title="text ? null : without" :data-text="text" @click="copy">{{ done ? "Copied" : label }}</button>`,
  };

  // Ctrl+Z and Ctrl+Y outside of fields, which have their own.
  const Keys = {
    emits: ["undo", "redo"],
    mounted() { window.addEventListener("keydown", this.key); },
    unmounted() { window.removeEventListener("keydown", this.key); },
    methods: {
      key(e) {
        if (!(e.ctrlKey || e.metaKey) || /^(text|search|number)$/.test(e.target.type ?? "")) return;
        const name = e.key === "z" && !e.shiftKey ? "undo" : e.key === "y" || (e.key.toLowerCase() === "z" && e.shiftKey) ? "redo" : "";
        if (name) { e.preventDefault(); this.$emit(name); }
      },
    },
    template: "<span hidden></span>",
  };

  return {
    install(app) {
      document.querySelector("meta[name=viewport]")?.setAttribute("content", "width=device-width, initial-scale=1");  // trame's forbids to zoom
      const parts = { chart: Chart, polar: Polar, orbit: Orbit, bearing: Bearing, numbers: Numbers, curves: Curves, answer: Answer, verdict: Verdict, designation: Designation, form: Form, copy: Copy, keys: Keys };
      app.config.globalProperties.same_bearing = sameBearing;
      for (const [name, part] of Object.entries(parts)) app.component("raceway-" + name, part);
    },
  };
}());
