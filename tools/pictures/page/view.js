// What is seen: the camera that all panels share, and their drawing with WebGL 2.

const canvas = document.getElementById('canvas');
const gl = canvas.getContext('webgl2', {antialias: !drawsWithoutCard(), alpha: false});

/// Whether the processor draws: then several samples a pixel are too many.
function drawsWithoutCard() {
  const probe = document.createElement('canvas').getContext('webgl2');
  let renderer = probe?.getParameter(probe.RENDERER) ?? '';
  if (renderer === 'WebKit WebGL') {  // what Chromium says instead
    const names = probe.getExtension('WEBGL_debug_renderer_info');
    if (names) renderer = probe.getParameter(names.UNMASKED_RENDERER_WEBGL);
  }
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}

const GAP = 3;  // between panels [pixels of the page]
const VIEW_ANGLE = 24 * Math.PI / 180;  // from bottom to top
const METHOD_COLOURS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#b58900', '#56b4e9', '#444444'];

const TEXTURES = ['Checker', 'Stripes', 'Grid'];

/// What the controls set. colour: an entry of TEXTURES, and after these one of run.colours.
const state = {
  frame: 0, time: run.times[0], playing: false, speed: 1, colour: 0,
  shown: run.methods.map(() => true), walls: true, follow: true,
};
const camera = {};

function resetCamera() {
  Object.assign(camera, {azimuth: 0, elevation: Math.asin(dot(UP, FROM)), zoom: 1, pan: [0, 0, 0]});
}

// Everything is drawn about the lower corner of the surfaces' box: single precision is enough there.
const ORIGIN = run.box.lower;
const UP = normalized(run.view.up), FROM = normalized(run.view.from);
const AHEAD = normalized(minus(FROM, times(dot(FROM, UP), UP))), ASIDE = cross(UP, AHEAD);
const FIRST_AXES = axesOf(FROM);
const WHOLE_FRAMING = wholeFraming();
const BALL = ballAround([run.box, ...(run.walls ? [run.walls] : [])]);
resetCamera();

/// Right, up, and towards the viewer, who is in that direction.
function axesOf(direction) {
  const right = normalized(cross(UP, direction));
  return [right, cross(direction, right), direction];
}

function ballAround(boxes) {
  const lower = [0, 1, 2].map(a => Math.min(...boxes.map(box => box.lower[a]))),
        upper = [0, 1, 2].map(a => Math.max(...boxes.map(box => box.upper[a])));
  return {centre: minus(times(0.5, plus(lower, upper)), ORIGIN), radius: 0.5 * Math.hypot(...minus(upper, lower))};
}

/// What holds the liquid of all frames.
function wholeFraming() {
  const along = run.framing.map(({centre, half}) => ({middle: FIRST_AXES.map(axis => dot(axis, centre)), half}));
  const lower = [0, 1, 2].map(a => Math.min(...along.map(f => f.middle[a] - f.half[a]))),
        upper = [0, 1, 2].map(a => Math.max(...along.map(f => f.middle[a] + f.half[a])));
  const middle = times(0.5, plus(lower, upper));
  const centre = [0, 1, 2].map(a => FIRST_AXES.reduce((sum, axis, k) => sum + middle[k] * axis[a], 0));
  return {centre, half: times(0.5, minus(upper, lower))};
}

function direction() {
  const {azimuth, elevation} = camera, level = Math.cos(elevation);
  return plus(plus(times(level * Math.cos(azimuth), AHEAD), times(level * Math.sin(azimuth), ASIDE)), times(Math.sin(elevation), UP));
}

/// Where the viewer stands for panels of that shape (width over height), and the matrix from there.
function viewer(aspect) {
  const {centre, half} = state.follow ? run.framing[state.frame] : WHOLE_FRAMING;
  const axes = axesOf(direction()), slope = Math.tan(VIEW_ANGLE / 2);
  const distance = camera.zoom * (half[2] + Math.max(half[0] / aspect, half[1], 1e-9) / slope);
  const eye = plus(plus(minus(centre, ORIGIN), camera.pan), times(distance, axes[2]));
  const away = dot(minus(eye, BALL.centre), axes[2]);
  const near = Math.max(away - BALL.radius, 0.02 * distance), far = Math.max(away + BALL.radius, 2 * near);
  return {axes, distance, matrix: matrixOf(axes, eye, slope, aspect, near, far)};
}

function matrixOf(axes, eye, slope, aspect, near, far) {
  const rows = [times(1 / (slope * aspect), axes[0]), times(1 / slope, axes[1]),
                times(-(far + near) / (far - near), axes[2]), times(-1, axes[2])];
  const constants = rows.map(row => -dot(row, eye));
  constants[2] -= 2 * far * near / (far - near);
  return Float32Array.from([0, 1, 2].flatMap(a => rows.map(row => row[a])).concat(constants));
}

const SURFACE_VERTEX = `#version 300 es
in vec3 place, rest;
in vec2 normal;
in float value;
uniform mat4 camera;
uniform vec3 placeScale, cubeScale, cubeOrigin;
out vec3 outward, cube;
out float colour;
void main() {
  vec2 o = (normal - 127.0) / 127.0;
  vec3 n = vec3(o, 1.0 - abs(o.x) - abs(o.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  outward = n;
  cube = rest * cubeScale + cubeOrigin;
  colour = value;
  gl_Position = camera * vec4(place * placeScale, 1.0);
}`;

// pattern: of TEXTURES, or -1: the colours. Where a pixel has one colour, one point of it is enough.
const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
in vec3 outward, cube;
in float colour;
uniform int pattern;
uniform sampler2D colours;
uniform vec3 key, side, halfway;
out vec4 result;
${TEXTURE_COLOURS}vec3 patternColour(vec3 x) {
  return pattern == 0 ? checkerColour(x) : pattern == 1 ? stripesColour(x) : gridColour(x);
}
bool hasOneColour(vec3 x, vec3 reach) {
  if (pattern == 0) return floor(x - reach) == floor(x + reach);
  if (pattern == 1) return floor(2.0 * dot(x - reach, vec3(1.0))) == floor(2.0 * dot(x + reach, vec3(1.0)));
  vec3 away = abs(x - round(x)) - reach;
  return min(away.x, min(away.y, away.z)) > 0.04;
}
vec3 meanColour() {
  vec3 right = dFdx(cube), up = dFdy(cube);
  if (hasOneColour(cube, 0.5 * (abs(right) + abs(up)))) return patternColour(cube);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += patternColour(cube + float(i - 1) / 3.0 * right + float(j - 1) / 3.0 * up);
  return sum / 9.0;
}
void main() {
  vec3 base = pattern >= 0 ? meanColour() : texture(colours, vec2((255.0 * colour + 0.5) / 256.0, 0.5)).rgb;
  vec3 n = normalize(outward);
  float lit = 0.4 + 0.7 * (0.8 * max(dot(n, key), 0.0) + 0.45 * max(dot(n, side), 0.0));
  float shine = max(dot(n, halfway), 0.0);
  shine *= shine; shine *= shine; shine *= shine; shine *= shine; shine *= shine;
  result = vec4(base * lit + (pattern >= 0 ? 0.12 : 0.04) * shine, 1.0);
}`;

// Much of a picture is walls: their light is found once a triangle.
const WALL_VERTEX = `#version 300 es
in vec3 place, normal;
uniform mat4 camera;
uniform vec3 placeScale, placeOrigin, key, side, viewer;
uniform bool shaded;
flat out float lit;
void main() {
  vec3 n = normalize(dot(normal, viewer) < 0.0 ? -normal : normal);
  lit = shaded ? 0.38 + 0.66 * (0.8 * max(dot(n, key), 0.0) + 0.45 * max(dot(n, side), 0.0)) : 1.0;
  gl_Position = camera * vec4(place * placeScale + placeOrigin, 1.0);
}`;

const WALL_FRAGMENT = `#version 300 es
precision mediump float;
flat in float lit;
uniform vec4 paint;
out vec4 result;
void main() {
  result = vec4(paint.rgb * lit, paint.a);
}`;

/// A program with its uniforms by name, and the places of its attributes in the order given.
function program(vertex, fragment, attributes) {
  const linked = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(linked, shader);
  }
  attributes.forEach((name, i) => gl.bindAttribLocation(linked, i, name));
  gl.linkProgram(linked);
  if (!gl.getProgramParameter(linked, gl.LINK_STATUS))
    throw new Error(gl.getAttachedShaders(linked).map(s => gl.getShaderInfoLog(s)).join() + gl.getProgramInfoLog(linked));
  const uniforms = {};
  for (let i = 0; i < gl.getProgramParameter(linked, gl.ACTIVE_UNIFORMS); ++i) {
    const {name} = gl.getActiveUniform(linked, i);
    uniforms[name] = gl.getUniformLocation(linked, name);
  }
  return {linked, uniforms};
}

function vertexArray(attributes) {
  const array = gl.createVertexArray(), buffer = gl.createBuffer(), corners = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, corners);
  attributes.forEach(([size, type, normalised, stride, offset], i) => {
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, size, type, normalised, stride, offset);
  });
  return {array, buffer, corners};
}

let surfaceProgram, wallProgram, meshes, wallMesh, colourTexture;

function startDrawing() {
  surfaceProgram = program(SURFACE_VERTEX, SURFACE_FRAGMENT, ['place', 'rest', 'normal', 'value']);
  wallProgram = program(WALL_VERTEX, WALL_FRAGMENT, ['place', 'normal']);
  meshes = run.methods.map(() => ({
    ...vertexArray([[3, gl.UNSIGNED_SHORT, false, VERTEX_BYTES, 0], [3, gl.UNSIGNED_SHORT, false, VERTEX_BYTES, 6],
                    [2, gl.UNSIGNED_BYTE, false, VERTEX_BYTES, NORMAL_AT], [1, gl.UNSIGNED_BYTE, true, VERTEX_BYTES, COLOUR_AT]]),
    frame: -1, colour: 0,
  }));
  wallMesh = {...vertexArray([[3, gl.UNSIGNED_SHORT, false, WALL_BYTES, 0], [3, gl.BYTE, false, WALL_BYTES, WALL_NORMAL_AT]]), frame: -1, viewer: -1};
  colourTexture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, colourTexture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(768));
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.clearColor(1, 1, 1, 1);
  gl.enable(gl.DEPTH_TEST);
  gl.enable(gl.SCISSOR_TEST);
  gl.polygonOffset(1, 1);
}

/// Panels in rows, as large as can be: [method, left, top, width, height] in pixels of the page.
function panels() {
  const shown = run.methods.map((_, m) => m).filter(m => state.shown[m]);
  const width = canvas.clientWidth, height = canvas.clientHeight;
  let best = {side: 0};
  for (let columns = 1; columns <= shown.length; ++columns) {
    const rows = Math.ceil(shown.length / columns), w = width / columns, h = height / rows, side = Math.min(w, 1.1 * h);
    if (side > best.side) best = {side, columns, w, h};
  }
  return shown.map((m, i) => [m, i % best.columns * best.w, Math.floor(i / best.columns) * best.h, best.w - GAP, best.h - GAP]);
}

function setLights(uniforms, axes) {
  const inWorld = light => normalized([0, 1, 2].map(a => light[0] * axes[0][a] + light[1] * axes[1][a] + light[2] * axes[2][a]));
  const key = inWorld([0.3, 1, 0.9]);
  gl.uniform3fv(uniforms.key, key);
  gl.uniform3fv(uniforms.side, inWorld([-1, 0.1, 0.7]));
  gl.uniform3fv(uniforms.halfway ?? null, normalized(plus(key, axes[2])));
  gl.uniform3fv(uniforms.viewer ?? null, axes[2]);
}

/// The surface's arrays on their way to the processor that draws, when they are others than last time.
function bindSurface(m) {
  const mesh = meshes[m], surface = surfaces[state.frame][m];
  gl.bindVertexArray(mesh.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
  if (mesh.frame !== state.frame) {
    gl.bufferData(gl.ARRAY_BUFFER, surface.buffer, gl.DYNAMIC_DRAW);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, surface.corners, gl.DYNAMIC_DRAW);
    mesh.frame = state.frame;
  }
  gl.vertexAttribPointer(3, 1, gl.UNSIGNED_BYTE, true, VERTEX_BYTES, COLOUR_AT + Math.max(state.colour - TEXTURES.length, 0));
  return surface;
}

function drawSurface(m, {axes, matrix}) {
  const {linked, uniforms} = surfaceProgram, steps = box => minus(box.upper, box.lower).map(x => x / 65535);
  gl.useProgram(linked);
  setLights(uniforms, axes);
  gl.uniformMatrix4fv(uniforms.camera, false, matrix);
  gl.uniform3fv(uniforms.placeScale, steps(run.box));
  gl.uniform3fv(uniforms.cubeScale, times(1 / run.checker.edge, steps(run.rest)));
  gl.uniform3fv(uniforms.cubeOrigin, times(1 / run.checker.edge, minus(run.rest.lower, run.checker.origin)));
  gl.uniform1i(uniforms.pattern, state.colour < TEXTURES.length ? state.colour : -1);
  const surface = bindSurface(m);
  gl.enable(gl.CULL_FACE);  // surfaces are closed
  gl.drawElements(gl.TRIANGLES, surface.corners.length, surface.corners.BYTES_PER_ELEMENT === 4 ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT, 0);
  gl.disable(gl.CULL_FACE);
}

/// The walls' triangles, those first that hide nothing from this viewer, then their edges.
function bindWalls(towards) {
  gl.bindVertexArray(wallMesh.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, wallMesh.buffer);
  const frame = Math.min(state.frame, walls.buffers.length - 1);
  if (wallMesh.frame !== frame) gl.bufferData(gl.ARRAY_BUFFER, walls.buffers[wallMesh.frame = frame], gl.DYNAMIC_DRAW);
  const nearness = run.walls.viewers.map(v => dot(v, towards)), viewer = nearness.indexOf(Math.max(...nearness));
  if (wallMesh.viewer === viewer) return;
  const solid = [], glass = [];
  walls.hides.forEach((bits, t) => (bits >>> viewer & 1 ? glass : solid).push(3 * t, 3 * t + 1, 3 * t + 2));
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, Uint32Array.from([...solid, ...glass, ...walls.edges]), gl.DYNAMIC_DRAW);
  Object.assign(wallMesh, {viewer, solid: solid.length, glass: glass.length});
}

function drawWalls({axes, matrix}) {
  const {linked, uniforms} = wallProgram;
  gl.useProgram(linked);
  setLights(uniforms, axes);
  gl.uniformMatrix4fv(uniforms.camera, false, matrix);
  gl.uniform3fv(uniforms.placeScale, minus(run.walls.upper, run.walls.lower).map(x => x / 65535));
  gl.uniform3fv(uniforms.placeOrigin, minus(run.walls.lower, ORIGIN));
  bindWalls(axes[2]);
  const part = (mode, begin, count, paint, shaded) => {
    gl.uniform4fv(uniforms.paint, paint);
    gl.uniform1i(uniforms.shaded, shaded);
    gl.drawElements(mode, count, gl.UNSIGNED_INT, 4 * begin);
  };
  gl.enable(gl.POLYGON_OFFSET_FILL);
  part(gl.TRIANGLES, 0, wallMesh.solid, [0.9, 0.91, 0.92, 1], true);
  gl.disable(gl.POLYGON_OFFSET_FILL);
  part(gl.LINES, wallMesh.solid + wallMesh.glass, walls.edges.length, [0.62, 0.65, 0.69, 1], false);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  gl.depthMask(false);
  part(gl.TRIANGLES, wallMesh.solid, wallMesh.glass, [0.75, 0.79, 0.84, 0.12], true);
  gl.depthMask(true);
  gl.disable(gl.BLEND);
}

/// Pixels of the canvas for one of the page. sharpness: 1, or less while things move and drawing is slow.
let sharpness = 1;
function pixelRatio() {
  return sharpness * Math.min(window.devicePixelRatio || 1, 1.5);
}

function draw() {
  const ratio = pixelRatio(), width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
  gl.scissor(0, 0, width, height);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  if (surfaces.length <= state.frame) return;
  for (const [m, left, top, w, h] of panels()) {
    const rectangle = [left, canvas.clientHeight - top - h, w, h].map(x => Math.round(x * ratio));
    gl.viewport(...rectangle);
    gl.scissor(...rectangle);
    const view = viewer(w / h);
    drawSurface(m, view);
    if (walls && state.walls) drawWalls(view);
  }
}
