"use strict";
// Components of the application's page; state and changes come and go by trame.
window.raceway_app = (function () {
  const COLOURS = ["#0b5fa5", "#a8480f"];
  const FIRST = ["load.axial", "excitation.speed_rpm", "kinematics.spin_speed_rpm", "excitation.unbalance", "excitation.force",
    "bearing.preload", "bearing.contact_angle_deg"];
  // Ends of sliders that begin at 0.
  const START = { "load.axial": 2000, "excitation.speed_rpm": 20000, "kinematics.spin_speed_rpm": 20000, "excitation.unbalance": 1e-3,
    "excitation.force": 1000, "bearing.preload": 1000, "bearing.contact_angle_deg": 40 };
  const number = (v, digits = 4) => v === null || v === undefined ? "-" : String(Number(v.toPrecision(digits)));

  // 1, 2 or 5 times a power of ten, some `count` of them from low to high.
  function ticks(low, high, count) {
    const raw = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].find((f) => f * power >= raw) * power, out = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) out.push(k * step);
    return out;
  }

  const Chart = {
    props: ["chart", "names"],
    data: () => ({ at: null }),
    computed: {
      frame() {
        const xs = this.chart.series.flatMap((s) => s.x), ys = this.chart.series.flatMap((s) => s.y).filter((y) => y !== null);
        let [x0, x1] = [Math.min(...xs), Math.max(...xs)], [y0, y1] = ys.length ? [Math.min(...ys), Math.max(...ys)] : [0, 1];
        if (y0 > 0 && y0 < 0.6 * y1) y0 = 0;
        if (y1 - y0 < 1e-3 * Math.abs(y1) || y1 === y0) { const pad = 0.02 * Math.abs(y1) || 1; y0 -= pad; y1 += pad; }
        y1 += 0.06 * (y1 - y0);
        return { x0, x1, y0, y1, x: (v) => 58 + 286 * (v - x0) / (x1 - x0 || 1), y: (v) => 166 - 138 * (v - y0) / (y1 - y0) };
      },
      lines() {
        const f = this.frame, seen = {};
        return this.chart.series.map((s) => {
          let path = "", pen = "M";
          s.x.forEach((x, i) => {  // a gap where there is no answer
            if (s.y[i] === null) { pen = "M"; return; }
            path += pen + f.x(x).toFixed(1) + " " + f.y(s.y[i]).toFixed(1);
            pen = "L";
          });
          const k = s.x.indexOf(s.present), nth = seen[s.panel] = (seen[s.panel] ?? -1) + 1;
          const dot = k >= 0 && s.y[k] !== null ? { x: f.x(s.present), y: f.y(s.y[k]), value: s.y[k] } : null;
          return { path, dot, colour: COLOURS[s.panel], dash: nth ? "5 3" : "", name: this.names[s.panel] + ": " + s.label };
        });
      },
      same() { return new Set(this.chart.series.map((s) => s.label)).size === 1; },
      title() { return this.same ? this.chart.series[0].label : this.chart.panel; },
      xs() { return ticks(this.frame.x0, this.frame.x1, 5); },
      ys() { return ticks(this.frame.y0, this.frame.y1, 4); },
      label() {
        const now = this.lines.filter((l) => l.dot).map((l) => l.name + " " + number(l.dot.value) + " " + this.chart.unit);
        return this.chart.panel + " over " + this.chart.label + "; " + (now.join(", ") || "no answer at the present point");
      },
      reading() {
        if (this.at === null) return this.lines.filter((l) => l.dot).map((l) => ({ colour: l.colour, text: (this.same ? l.name.split(":")[0] : l.name) + " " + number(l.dot.value) }));
        return this.chart.series.map((s) => {
          let best = 0;
          s.x.forEach((x, i) => { if (Math.abs(x - this.at) < Math.abs(s.x[best] - this.at)) best = i; });
          return { colour: COLOURS[s.panel], text: this.names[s.panel] + " " + number(s.y[best]) + " at " + number(s.x[best], 5) };
        });
      },
    },
    methods: {
      number,
      move(event) {
        const box = this.$refs.svg.getBoundingClientRect(), x = (event.clientX - box.left) * 364 / box.width, f = this.frame;
        this.at = x < 58 || x > 344 ? null : f.x0 + (x - 58) / 286 * (f.x1 - f.x0);
      },
    },
    template: `<figure class="chart" :data-test="'chart-' + chart.axis + '-' + chart.panel">
      <figcaption><b>{{ title }}</b> <span v-if="chart.unit && chart.unit !== '1'">[{{ chart.unit }}]</span>
        <span v-for="r in reading" class="reading" :style="{ color: r.colour }">{{ r.text }}</span></figcaption>
      <svg v-if="lines.length" ref="svg" viewBox="0 0 364 206" role="img" :aria-label="label" @pointermove="move" @pointerleave="at = null">
        <path v-for="x in xs" class="rule" :d="'M' + frame.x(x) + ' 22V166'"/><path v-for="y in ys" class="rule" :d="'M58 ' + frame.y(y) + 'H344'"/>
        <text v-for="x in xs" :x="frame.x(x)" y="181" text-anchor="middle">{{ number(x) }}</text>
        <text v-for="y in ys" x="53" :y="frame.y(y) + 4" text-anchor="end">{{ number(y) }}</text>
        <text x="203" y="199" text-anchor="middle">{{ chart.label }}</text>
        <g v-for="l in lines"><path class="line" :d="l.path" :stroke="l.colour" :stroke-dasharray="l.dash"/>
          <circle v-if="l.dot" :cx="l.dot.x" :cy="l.dot.y" r="4.5" :fill="l.colour"/></g>
      </svg>
      <p class="small" v-for="n in chart.notes">{{ n }}</p></figure>`,
  };

  const Polar = {
    props: ["balls"],
    computed: {
      top() { return Math.max(1e-12, ...this.balls.flatMap((b) => [b[1], b[2]])); },
      bars() {
        return this.balls.map((b, k) => {
          const a = b[0] * Math.PI / 180, at = (r) => [90 + r * Math.cos(a), 84 - r * Math.sin(a)], reach = (q) => 18 + 48 * q / this.top;
          return { outer: [at(18), at(reach(b[2]))], inner: [at(18), at(reach(b[1]))], name: at(76), k, alone: this.balls.findIndex((c) => Math.abs(c[0] - b[0]) < 1e-6) === k, text: k + ": " + number(b[1]) + " N inner, " + number(b[2]) + " N outer" };
        });
      },
    },
    methods: { number },
    template: `<figure><svg viewBox="0 0 180 168" role="img" :aria-label="'Ball loads round the bearing: ' + bars.map((b) => b.text).join('; ')">
      <circle class="rule" cx="90" cy="84" r="18"/><circle class="rule" cx="90" cy="84" r="66"/>
      <g v-for="b in bars"><title>{{ b.text }}</title>
        <line class="outer" :x1="b.outer[0][0]" :y1="b.outer[0][1]" :x2="b.outer[1][0]" :y2="b.outer[1][1]"/>
        <line class="inner" :x1="b.inner[0][0]" :y1="b.inner[0][1]" :x2="b.inner[1][0]" :y2="b.inner[1][1]"/>
        <text v-if="b.alone" :x="b.name[0]" :y="b.name[1] + 4" text-anchor="middle">{{ b.k }}</text></g></svg>
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
      <p class="small" ref="words">Drag or arrow keys to turn, wheel, fingers, + and - to zoom; point at a ball for its numbers.</p>
      <p class="rings"><label><input type="checkbox" v-model="outer"> outer ring</label><label><input type="checkbox" v-model="inner"> inner ring</label></p>
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
            const again = nth[name] = (nth[name] ?? -1) + 1, key = [section, value || !name ? name : "", again].join("|");
            if (!rows.has(key)) rows.set(key, { name, heading: !value, cells: {} });
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
    template: `<div v-for="(s, k) in screens"><p class="warning" v-for="w in s?.warnings">{{ 'AB'[k] }}: {{ w }}</p></div>
      <div class="scroll" tabindex="0" role="region" aria-label="Numbers"><table data-test="numbers"><thead><tr><th scope="col">quantity</th>
        <th v-for="(s, k) in screens" scope="col" class="number" :data-number="s?.number">{{ 'AB'[k] }}</th><th scope="col" v-if="screens.length < 2">remark</th></tr></thead>
      <tbody><tr v-for="r in rows" :class="{ heading: r.heading }"><th scope="row" :colspan="r.heading ? screens.length + 1 : 1">{{ r.heading ? both(r, "name") : r.name }}<span class="small" v-if="screens.length > 1">{{ both(r, "remark") }}</span></th>
        <template v-if="!r.heading"><td v-for="(s, k) in screens" class="number" :class="{ stale: busy[k] }" :data-test="'value-' + k" :data-name="r.name">{{ r.cells[k]?.value ?? '' }}</td></template>
        <td class="small" v-if="screens.length < 2">{{ both(r, "remark") }}</td></tr></tbody></table></div>
      <p class="small" v-for="(s, k) in screens"><template v-if="s">{{ 'AB'[k] }}: {{ s.bearing.split('\\n').slice(1).join('; ') }}; {{ s.left_out }}</template></p>`,
  };

  const Ranges = {
    props: ["charts"], emits: ["range"],
    computed: {
      axes() {
        const axes = {};
        for (const c of this.charts) if (c.series.length) axes[c.axis] ??= { name: c.axis, label: c.label, low: c.series[0].x[0], high: c.series[0].x.at(-1) };
        return Object.values(axes);
      },
    },
    methods: {
      send(axis, field, end) {  // what is refused does not stay
        const ends = { ...axis, [end]: field.value === "" ? null : +field.value };
        field.value = axis[end];
        this.$emit("range", axis.name, ends.low, ends.high);
      },
    },
    template: `<p class="small" v-for="a in axes" :key="a.name">{{ a.label }} from
      <input type="number" :aria-label="a.label + ', from'" :value="a.low" @change="send(a, $event.target, 'low')"> to
      <input type="number" :aria-label="a.label + ', to'" :value="a.high" @change="send(a, $event.target, 'high')"></p>`,
  };

  const Form = {
    props: ["panels", "forms", "busy"], emits: ["set"],
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
        const fits = (f) => words.every((w) => (f.path + " " + f.help + " " + f.unit).toLowerCase().includes(w));
        return this.form.map((g) => ({ name: g.name, fields: g.fields.filter(fits) })).filter((g) => g.fields.length);
      },
    },
    methods: {
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
          const waits = Object.keys(this.busy).length && performance.now() - this.sent < 400;
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
    template: `<div class="form"><label class="search">Search keys <input type="search" v-model="search"></label>
      <fieldset v-if="two"><legend>changes apply to</legend><label v-for="t in ['both', 'A', 'B']"><input type="radio" name="target" :value="t" v-model="target"> {{ t }}</label></fieldset>
      <fieldset class="first" v-show="!search"><legend>most used</legend><div v-for="f in first" :key="f.path" class="slider"><label :for="'s-' + f.path">{{ f.path }} <small>{{ holds(f.path) }} {{ f.unit }}</small></label>
        <input type="range" :id="'s-' + f.path" :data-slider="f.path" :min="parseFloat(holds(f.path)) < 0 ? -top(f) : 0" :max="top(f)" :step="top(f) / 200" :value="parseFloat(holds(f.path))"
          @input="drag(f, $event.target.value)" @change="dragged = null"></div></fieldset>
      <details v-for="g in groups" :key="g.name" :open="!!search || open[g.name]" @toggle="open[g.name] = $event.target.open">
        <summary>{{ g.name }}<span class="fault" v-if="g.fields.some((f) => faults[f.path])"> refused</span></summary>
        <template v-if="open[g.name] || search"><div v-for="f in g.fields" :key="f.path" class="field">
          <label :for="'f-' + f.path">{{ f.label }} <small v-if="f.unit">[{{ f.unit }}]</small></label>
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
      const parts = { chart: Chart, polar: Polar, orbit: Orbit, bearing: Bearing, numbers: Numbers, ranges: Ranges, form: Form, copy: Copy, keys: Keys };
      for (const [name, part] of Object.entries(parts)) app.component("raceway-" + name, part);
    },
  };
}());
