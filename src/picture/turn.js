// Two canvases that turn together: a surface and its image. WebGL 2; where it is missing the block stays hidden.
"use strict";
function equimapTurn(block, data) {
  const bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const faces = new Uint32Array(bytes(data.faces).buffer), colours = bytes(data.colours);
  const vertex = `#version 300 es
    in vec3 position; in vec3 colour; uniform mat3 turn; uniform float zoom; out vec3 place, tint;
    void main() { place = turn * position; tint = colour; gl_Position = vec4(place.xy * zoom, -0.3 * place.z, 1.0); }`;
  const fragment = `#version 300 es
    precision highp float; in vec3 place, tint; uniform float relief; out vec4 seen;
    void main() {
      vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
      float light = 0.35 + 0.65 * max(dot(normal, normalize(vec3(-0.4, 0.55, 0.7))), 0.0);
      seen = vec4(tint * mix(1.0, light, relief), 1.0);
    }`;
  let yaw = data.yaw, pitch = data.pitch, zoom = 0.95, drawn = 0;

  // Every face has vertices of its own, so that it has one colour.
  function expand(points) {
    const positions = new Float32Array(3 * faces.length), low = [1e30, 1e30, 1e30], high = [-1e30, -1e30, -1e30];
    for (const v of faces) for (let d = 0; d < 3; d++) {
      low[d] = Math.min(low[d], points[3 * v + d]);
      high[d] = Math.max(high[d], points[3 * v + d]);
    }
    let radius = 0;
    for (const v of faces) {
      let squared = 0;
      for (let d = 0; d < 3; d++) squared += (points[3 * v + d] - 0.5 * (low[d] + high[d])) ** 2;
      radius = Math.max(radius, Math.sqrt(squared));
    }
    faces.forEach((v, k) => {
      for (let d = 0; d < 3; d++) positions[3 * k + d] = (points[3 * v + d] - 0.5 * (low[d] + high[d])) / radius;
    });
    return positions;
  }

  function makeProgram(gl) {
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    return program;
  }

  function attach(gl, program, name, kind, values, normalised) {
    const place = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, kind, normalised, 0, 0);
  }

  function makeView(canvas, points, flat) {
    const gl = canvas.getContext("webgl2", {preserveDrawingBuffer: true});
    if (!gl) return null;
    const program = makeProgram(gl), tints = new Uint8Array(3 * faces.length);
    for (let k = 0; k < tints.length; k++) tints[k] = colours[3 * Math.floor(k / 9) + k % 3];
    attach(gl, program, "position", gl.FLOAT, expand(points), false);
    attach(gl, program, "colour", gl.UNSIGNED_BYTE, tints, true);
    gl.enable(gl.DEPTH_TEST);
    return {gl, program, flat};
  }

  function draw(view) {
    const {gl, program, flat} = view, a = flat ? 0 : yaw, b = flat ? 0 : pitch;
    const x = data.right, y = data.up, z = data.toward, base = flat ? [1, 0, 0, 0, 1, 0, 0, 0, 1] : [
      x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]];
    const ca = Math.cos(a), sa = Math.sin(a), cb = Math.cos(b), sb = Math.sin(b);
    const spin = [ca, sa * sb, -sa * cb, 0, cb, sb, sa, -ca * sb, ca * cb]; // by columns: around y, then around x
    const turn = new Float32Array(9);
    for (let k = 0; k < 9; k++) for (let j = 0; j < 3; j++) turn[k] += spin[3 * j + k % 3] * base[3 * Math.floor(k / 3) + j];
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix3fv(gl.getUniformLocation(program, "turn"), false, turn);
    gl.uniform1f(gl.getUniformLocation(program, "zoom"), zoom);
    gl.uniform1f(gl.getUniformLocation(program, "relief"), flat ? 0 : 1);
    gl.drawArrays(gl.TRIANGLES, 0, faces.length);
  }

  const canvases = block.querySelectorAll("canvas");
  const views = [makeView(canvases[0], new Float32Array(bytes(data.surface).buffer), false),
                 makeView(canvases[1], new Float32Array(bytes(data.image).buffer), data.flat)];
  if (views.includes(null)) return;
  block.hidden = false;
  const redraw = () => { views.forEach(draw); block.dataset.drawn = ++drawn; };
  for (const canvas of canvases) {
    canvas.addEventListener("pointerdown", event => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", event => {
      if (!event.buttons) return;
      yaw += 0.01 * event.movementX;
      pitch += 0.01 * event.movementY;
      redraw();
    });
    canvas.addEventListener("wheel", event => {
      zoom *= Math.exp(-0.001 * event.deltaY);
      event.preventDefault();
      redraw();
    }, {passive: false});
  }
  redraw();
}
