"use strict";
// Draws a bearing into `stage`, which holds a canvas: of the page of `raceway view`, and of the application.
//   data: fixed_shapes and fixed_parts (rings), shapes and parts (balls, forces, contacts), balls, labels, reach, radius
//   words: element that states a ball's numbers;  shown(ring): whether "inner" or "outer" is drawn
// Returns update(data), which takes what has changed, and redraw(); null without WebGL.
window.raceway_stage = function (stage, words, shown, data) {
  const canvas = stage.querySelector("canvas"), hint = words.textContent;
  // Without a graphics card smooth edges cost half of the time.
  const probe = document.createElement("canvas").getContext("webgl"), renderer = probe?.getExtension("WEBGL_debug_renderer_info");
  const slow = !renderer || /swiftshader|llvmpipe|software/i.test(probe.getParameter(renderer.UNMASKED_RENDERER_WEBGL));
  const gl = probe && canvas.getContext("webgl", { alpha: false, antialias: !slow, preserveDrawingBuffer: true });
  if (!gl) return null;
  function bytes(text) {
    const raw = atob(text), out = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; k++) out[k] = raw.charCodeAt(k);
    return out;
  }
  function shader(kind, text) {
    const one = gl.createShader(kind);
    gl.shaderSource(one, text);
    gl.compileShader(one);
    if (!gl.getShaderParameter(one, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(one));
    return one;
  }
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER,
    "attribute vec3 p, n, c; uniform mat3 turn; uniform vec3 at; uniform vec2 size; uniform float deep; varying vec3 normal, tone;" +
    "void main() { vec3 q = turn * (p + at); normal = turn * n; tone = c; gl_Position = vec4(q.xy * size, -q.z * deep, 1.0); }"));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER,
    "precision mediump float; varying vec3 normal, tone; uniform vec4 colour; uniform float flat_;" +
    "void main() { vec3 n = normalize(normal); if (n.z < 0.0) n = -n;" +
    "float light = 0.38 + 0.62 * max(dot(n, normalize(vec3(0.35, 0.5, 1.0))), 0.0);" +
    "gl_FragColor = flat_ > 0.5 ? vec4(tone, 1.0) : vec4(colour.rgb * light, colour.a); }"));
  gl.linkProgram(program);
  gl.useProgram(program);
  const place = {};
  for (const name of ["turn", "at", "size", "deep", "colour", "flat_"]) place[name] = gl.getUniformLocation(program, name);
  const slots = ["p", "n", "c"].map((name) => gl.getAttribLocation(program, name));
  function buffer(kind, array) {
    const one = gl.createBuffer();
    gl.bindBuffer(kind, one);
    gl.bufferData(kind, array, gl.STATIC_DRAW);
    return one;
  }
  let shapes = {}, moving = [], labels = [];
  function made(s) {
    const index = new Uint16Array(bytes(s.triangles).buffer);
    return {
      p: buffer(gl.ARRAY_BUFFER, new Float32Array(bytes(s.points).buffer)),
      n: buffer(gl.ARRAY_BUFFER, new Int8Array(bytes(s.normals).buffer)),
      c: s.tones ? buffer(gl.ARRAY_BUFFER, bytes(s.tones)) : null,
      i: buffer(gl.ELEMENT_ARRAY_BUFFER, index), count: index.length,
    };
  }
  let yaw = 0.46, pitch = 0.4, zoom = 1.0, turn = null, size = [1, 1];
  // Seen along -x for yaw = pitch = 0: y to the right, z up.
  function rotation() {
    const a = Math.cos(yaw), b = Math.sin(yaw), c = Math.cos(pitch), d = Math.sin(pitch);
    return [-b, -d * a, c * a, a, -d * b, c * b, 0, c, d];  // columns: where x, y, z go
  }
  function on(x, y, z) {
    const r = turn;
    return [r[0] * x + r[3] * y + r[6] * z, r[1] * x + r[4] * y + r[7] * z, r[2] * x + r[5] * y + r[8] * z];
  }
  function free(shape) {
    for (const part of ["p", "n", "c", "i"]) if (shape && shape[part]) gl.deleteBuffer(shape[part]);
  }
  function update(news) {
    for (const name of moving) { free(shapes[name]); delete shapes[name]; }
    if (news.fixed_shapes) { Object.values(shapes).forEach(free); shapes = {}; }
    data = Object.assign({}, data, news);
    moving = Object.keys(news.shapes);
    for (const [name, shape] of Object.entries({ ...news.fixed_shapes, ...news.shapes })) shapes[name] = made(shape);
    while (labels.length > data.labels.length) labels.pop().remove();
    while (labels.length < data.labels.length) {
      labels.push(stage.appendChild(document.createElement("span")));
      labels[labels.length - 1].className = "label";
    }
    data.labels.forEach((label, k) => { labels[k].textContent = label.text; });
    redraw();
  }
  function draw() {
    const sharp = Math.min(window.devicePixelRatio || 1, 2), width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * sharp) || canvas.height !== Math.round(height * sharp)) {
      canvas.width = Math.round(width * sharp);
      canvas.height = Math.round(height * sharp);
    }
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.98, 0.985, 0.99, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const short = zoom / data.reach;
    size = width > height ? [short * height / width, short] : [short, short * width / height];
    turn = rotation();
    gl.uniformMatrix3fv(place.turn, false, turn);
    gl.uniform2fv(place.size, size);
    gl.uniform1f(place.deep, 0.4 / data.reach);
    gl.enable(gl.DEPTH_TEST);
    for (const glass of [false, true]) {
      (glass ? gl.enable : gl.disable).call(gl, gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(!glass);
      for (const part of [...data.fixed_parts, ...data.parts]) {
        if ((part.opacity < 1) !== glass || hidden(part.name)) continue;
        const s = shapes[part.shape];
        [[s.p, gl.FLOAT, false], [s.n, gl.BYTE, true], [s.c, gl.UNSIGNED_BYTE, true]].forEach(([one, kind, unit], k) => {
          if (one) {
            gl.bindBuffer(gl.ARRAY_BUFFER, one);
            gl.enableVertexAttribArray(slots[k]);
            gl.vertexAttribPointer(slots[k], kind === gl.FLOAT ? 3 : 4, kind, unit, 0, 0);
          } else gl.disableVertexAttribArray(slots[k]);
        });
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, s.i);
        gl.uniform3fv(place.at, part.at);
        gl.uniform4f(place.colour, ...part.colour, part.opacity);
        gl.uniform1f(place.flat_, s.c ? 1 : 0);
        gl.drawElements(gl.TRIANGLES, s.count, gl.UNSIGNED_SHORT, 0);
      }
    }
    gl.depthMask(true);
    const taken = [];  // a label that would lie on another one moves by a line or two, or is left out
    labels.forEach((span, k) => {
      const q = on(...data.labels[k].at), x = (q[0] * size[0] + 1) * width / 2, half = 3.4 * span.textContent.length;
      const free = (y) => taken.every((box) => Math.abs(box.x - x) > box.half + half || Math.abs(box.y - y) > 12);
      const middle = (1 - q[1] * size[1]) * height / 2, y = [0, 13, -13, 26, -26].map((away) => middle + away).find(free);
      if (y !== undefined) taken.push({ x, y, half });
      span.style.transform = "translate(" + x + "px," + (y ?? middle) + "px) translate(-50%,-50%)";
      span.style.visibility = y === undefined || x < 20 || y < 10 || x > width - 20 || y > height - 10 ? "hidden" : "visible";
    });
  }
  function hidden(name) { return ["outer", "inner"].some((ring) => name.startsWith(ring + " ring") && !shown(ring)); }
  let asked = false;
  function redraw() {
    if (!asked) requestAnimationFrame(() => { asked = false; draw(); });
    asked = true;
  }
  function point(event) {
    const box = canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left) / box.width - 1) / size[0], y = (1 - 2 * (event.clientY - box.top) / box.height) / size[1];
    let best = null;
    for (const ball of data.balls) {
      const q = on(...ball.at), away = Math.hypot(q[0] - x, q[1] - y);
      if (away < data.radius && (best === null || q[2] > best[0])) best = [q[2], ball];
    }
    words.textContent = best ? best[1].text : hint;
  }
  const down = new Map();
  canvas.addEventListener("pointerdown", (e) => { down.set(e.pointerId, e); canvas.setPointerCapture(e.pointerId); });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (e) => down.delete(e.pointerId));
  canvas.addEventListener("pointermove", (e) => {
    const old = down.get(e.pointerId);
    if (!old) return point(e);
    if (down.size === 2) {
      const other = [...down.values()].find((one) => one.pointerId !== e.pointerId);
      const apart = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
      zoom = Math.min(Math.max(zoom * apart(e) / Math.max(apart(old), 1), 0.3), 30);
    } else {
      yaw -= 0.008 * (e.clientX - old.clientX);
      pitch = Math.min(Math.max(pitch + 0.008 * (e.clientY - old.clientY), -1.55), 1.55);
    }
    down.set(e.pointerId, e);
    redraw();
  });
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    zoom = Math.min(Math.max(zoom * Math.exp(-0.0015 * e.deltaY), 0.3), 30);
    redraw();
  }, { passive: false });
  canvas.tabIndex = 0;
  canvas.addEventListener("keydown", (e) => {
    const step = { ArrowLeft: [0.1, 0, 1], ArrowRight: [-0.1, 0, 1], ArrowUp: [0, -0.1, 1], ArrowDown: [0, 0.1, 1], "+": [0, 0, 1.15], "-": [0, 0, 1 / 1.15] }[e.key];
    if (!step) return;
    e.preventDefault();
    yaw += step[0];
    pitch = Math.min(Math.max(pitch + step[1], -1.55), 1.55);
    zoom = Math.min(Math.max(zoom * step[2], 0.3), 30);
    redraw();
  });
  new ResizeObserver(redraw).observe(stage);
  update(data);
  draw();
  return { update, redraw };
};
