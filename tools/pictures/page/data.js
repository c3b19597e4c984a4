'use strict';
// The data of the page. What its elements hold, and how it is packed: surface_packer.h and page_surfaces.h.

const run = JSON.parse(document.getElementById('run').textContent);
const COMPONENT_BYTES = [2, 2, 2, 2, 2, 2, 1, 1, ...run.colours.map(() => 1)];
const NORMAL_AT = 12, COLOUR_AT = 14;  // of a vertex in its buffer, after position and rest position [bytes]
const VERTEX_BYTES = 4 * Math.ceil((COLOUR_AT + run.colours.length) / 4);

const WALL_BYTES = 12, WALL_NORMAL_AT = 6;

const bytesOf = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));

/// The bytes of an element, which is not needed after that.
async function inflated(id) {
  const element = document.getElementById(id);
  const stream = new Blob([bytesOf(element.textContent)]).stream().pipeThrough(new DecompressionStream('deflate'));
  element.remove();
  return new Response(stream).arrayBuffer();
}

const bitAt = (bytes, begin, i) => bytes[begin + (i >> 3)] >> (i & 7) & 1;
const unfolded = u => u & 1 ? -(u + 1) / 2 : u / 2;

/// Unpacks the frames of one surface in their order.
class SurfaceUnpacker {
  #components = COMPONENT_BYTES.map(() => new Uint16Array(0));
  #vertices = 0;
  #corners = new Uint32Array(0);

  unpack(buffer) {
    this.bytes = new Uint8Array(buffer);
    const [vertices, fresh] = new Uint32Array(buffer, 0, 2);
    const before = this.#kept(8, this.#vertices);
    let at = 8 + Math.ceil(this.#vertices / 8);
    const corners = this.#keptCorners(at, before, fresh);
    at += Math.ceil(this.#corners.length / 24);
    this.#components = this.#components.map((last, c) => {
      const values = this.#component(at, COMPONENT_BYTES[c], vertices, last, before);
      at += COMPONENT_BYTES[c] * vertices;
      return values;
    });
    this.#addCorners(at, corners, fresh);
    this.#vertices = vertices;
    this.#corners = corners;
    this.bytes = null;
    return {vertices, triangles: corners.length / 3, buffer: this.#interleaved(), corners: vertices > 65535 ? corners : Uint16Array.from(corners)};
  }

  /// Those of the last frame that are still there, in this frame's order.
  #kept(at, count) {
    const kept = [];
    for (let i = 0; i < count; ++i) if (bitAt(this.bytes, at, i)) kept.push(i);
    return kept;
  }

  #keptCorners(at, before, fresh) {
    const number = new Uint32Array(this.#vertices);
    before.forEach((old, now) => { number[old] = now; });
    const kept = this.#kept(at, this.#corners.length / 3), corners = new Uint32Array(3 * (kept.length + fresh));
    kept.forEach((t, k) => { for (let c = 0; c < 3; ++c) corners[3 * k + c] = number[this.#corners[3 * t + c]]; });
    return corners;
  }

  #component(at, width, vertices, last, before) {
    const values = new Uint16Array(vertices), mask = width === 2 ? 0xffff : 0xff;
    for (let v = 0, previous = 0; v < vertices; ++v) {
      const difference = unfolded(this.bytes[at + v] | (width === 2 ? this.bytes[at + vertices + v] << 8 : 0));
      values[v] = previous = (v < before.length ? last[before[v]] : previous) + difference & mask;
    }
    return values;
  }

  #addCorners(at, corners, fresh) {
    const number = (c, i) => {
      const byte = plane => this.bytes[at + (4 * c + plane) * fresh + i];
      return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
    };
    const begin = corners.length - 3 * fresh;
    for (let i = 0, first = 0; i < fresh; ++i) {
      first += number(0, i);
      corners.set([first, first + number(1, i), first + number(2, i)], begin + 3 * i);
    }
  }

  /// As it is drawn from.
  #interleaved() {
    const vertices = this.#components[0].length, buffer = new ArrayBuffer(VERTEX_BYTES * vertices);
    const wide = new Uint16Array(buffer), narrow = new Uint8Array(buffer);
    this.#components.forEach((values, c) => {
      const [array, stride, offset] = COMPONENT_BYTES[c] === 2 ? [wide, VERTEX_BYTES / 2, c] : [narrow, VERTEX_BYTES, NORMAL_AT + c - 6];
      for (let v = 0; v < vertices; ++v) array[stride * v + offset] = values[v];
    });
    return buffer;
  }
}

/// surfaces[frame][method]; grows until all frames are there.
const surfaces = [];
let walls = null;

async function loadWalls() {
  const corners = new Uint32Array(await inflated('walls-corners')), hides = new Uint32Array(await inflated('walls-hides'));
  const buffers = [];
  let edges;
  for (let f = 0; f < run.walls.frames; ++f) {
    const places = new Uint16Array(await inflated(`walls-${f}`)), normals = wallNormals(corners, places);
    edges ??= sharpEdges(corners, places, normals);
    buffers.push(wallBuffer(corners, places, normals));
  }
  walls = {hides, buffers, edges};
}

function wallNormals(corners, places) {
  const scale = run.walls.upper.map((x, a) => (x - run.walls.lower[a]) / 65535), normals = [];
  const point = v => scale.map((s, a) => s * places[3 * v + a]);
  for (let t = 0; t < corners.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map(k => point(corners[t + k]));
    normals.push(normalized(cross(minus(b, a), minus(c, a))));
  }
  return normals;
}

/// A vertex for each corner of each triangle: its place, and the triangle's normal in 127ths.
function wallBuffer(corners, places, normals) {
  const buffer = new ArrayBuffer(WALL_BYTES * corners.length), wide = new Uint16Array(buffer), narrow = new Int8Array(buffer);
  corners.forEach((v, i) => {
    wide.set(places.subarray(3 * v, 3 * v + 3), WALL_BYTES / 2 * i);
    narrow.set(normals[Math.floor(i / 3)].map(x => Math.round(127 * x)), WALL_BYTES * i + WALL_NORMAL_AT);
  });
  return buffer;
}

async function loadSurfaces(onFrame) {
  const unpackers = run.methods.map(() => new SurfaceUnpacker());
  for (let frame = 0; frame < run.times.length; ++frame) {
    const buffers = await Promise.all(unpackers.map((_, m) => inflated(`surface-${m}-${frame}`)));
    surfaces.push(buffers.map((buffer, m) => unpackers[m].unpack(buffer)));
    onFrame(frame);
  }
}

/// The edges between triangles that meet at more than 40 degrees, and rims: pairs of corners.
function sharpEdges(corners, places, normals) {
  const placeName = i => places.subarray(3 * corners[i], 3 * corners[i] + 3).join();
  const sides = new Map();  // of the edge between two places: its ends, and the normals of its triangles
  corners.forEach((_, i) => {
    const t = Math.floor(i / 3), ends = [i, 3 * t + (i + 1) % 3], name = ends.map(placeName).sort().join(' ');
    if (!sides.has(name)) sides.set(name, {ends, normals: []});
    sides.get(name).normals.push(normals[t]);
  });
  const sharp = [...sides.values()].filter(side => side.normals.length !== 2 || dot(...side.normals) < 0.766);
  return Uint32Array.from(sharp.flatMap(({ends}) => ends));
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => a.map((x, i) => x - b[i]);
const plus = (a, b) => a.map((x, i) => x + b[i]);
const times = (s, a) => a.map(x => s * x);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const normalized = a => times(1 / (Math.hypot(...a) || 1), a);
