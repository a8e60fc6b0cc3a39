// data.js - what pccdctl inspect wrote into the page (client/ctl/inspect/inspect_data.h).
//
// Each blob is an element with base64 text. A section begins at a multiple of 12 bytes, so
// that its part of the text can be decoded without the rest.

import { byId } from "./dom.js";

const FORMAT = 2;
const KIND_SHIFT = 6; // of a contact's kind, over its flags
export const INITIAL = 2;
export const INSIDE = 4;
const CONTACT_BYTES = 24;
const LINE_BYTES = 32;
const EVENT_BYTES = 20;
const BOX_BYTES = 48;
const STEPS_KEPT = 12; // decoded ones

/** By enum pccd_kind: name, short name, and how many points each of the two features has. */
export const KINDS = [
  { name: "vertex-face", id: "vf", points: [1, 3] },
  { name: "edge-edge", id: "ee", points: [2, 2] },
  { name: "vertex-edge", id: "ve", points: [1, 2] },
  { name: "vertex-vertex", id: "vv", points: [1, 1] },
];
export const FEATURES = ["", "vertex", "edge", "face"]; // by their points
export const EVENT_KINDS = ["step", "refit", "task unit", "subtree", "pairs", "high-level node",
  "tests", "rebuild", "built in the background", "wait", "merge"];

function decode(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) {
    bytes[i] = binary.charCodeAt(i);
  }
  return bytes;
}

/** `bytes` bytes of a section, aligned for any array of numbers. */
function section([blob, offset], bytes) {
  const text = byId(`pccd-${String(blob).padStart(8, "0")}`).firstChild?.data ?? "";
  const begin = (offset / 3) * 4;
  const decoded = decode(text.slice(begin, begin + Math.ceil(bytes / 3) * 4));
  return decoded.buffer.slice(0, bytes);
}

/** A map that forgets what was not used for longest. */
function makeCache(make, kept) {
  const items = new Map();
  return (key, ...rest) => {
    const item = items.has(key) ? items.get(key) : make(key, ...rest);
    items.delete(key);
    items.set(key, item);
    if (items.size > kept) {
      items.delete(items.keys().next().value);
    }
    return item;
  };
}

/** The unique edges, numbered by (larger, smaller vertex) as in the records; `rods`: ends of
 * those that no triangle has. */
function edgesOf(triangles, rods, vertexCount) {
  const keys = new Float64Array(triangles.length + rods.length / 2);
  for (let i = 0; i < rods.length; i += 2) {
    keys[triangles.length + i / 2] =
      Math.max(rods[i], rods[i + 1]) * vertexCount + Math.min(rods[i], rods[i + 1]);
  }
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 0; k < 3; k++) {
      const p = triangles[i + k];
      const q = triangles[i + (k + 1) % 3];
      keys[i + k] = Math.max(p, q) * vertexCount + Math.min(p, q);
    }
  }
  keys.sort();
  const edges = new Uint32Array(2 * keys.length);
  let count = 0;
  for (let i = 0; i < keys.length; i++) {
    const a = keys[i] % vertexCount;
    const b = (keys[i] - a) / vertexCount;
    if ((i === 0 || keys[i] !== keys[i - 1]) && a !== b) {
      edges[2 * count] = a;
      edges[2 * count + 1] = b;
      count++;
    }
  }
  return edges.slice(0, 2 * count);
}

function readPositions(place, vertexCount, isRounded) {
  if (!isRounded) {
    return new Float32Array(section(place, 12 * vertexCount));
  }
  const buffer = section(place, 24 + 6 * vertexCount);
  const head = new Float32Array(buffer, 0, 6);
  const numbers = new Uint16Array(buffer, 24, 3 * vertexCount);
  return Float32Array.from(numbers, (number, i) => head[i % 3] + head[3 + (i % 3)] * number);
}

/** Columns, so that a hundred thousand contacts stay small. */
function readContacts({ at, count }) {
  const buffer = section(at, CONTACT_BYTES * count);
  const view = new DataView(buffer);
  const contacts = {
    count,
    featureA: new Uint32Array(count),
    featureB: new Uint32Array(count),
    objectA: new Uint16Array(count),
    objectB: new Uint16Array(count),
    toi: new Float32Array(count),
    u: new Float32Array(count),
    v: new Float32Array(count),
    normal: new Float32Array(3 * count),
    kind: new Uint8Array(count),
    flags: new Uint8Array(count),
  };
  for (let i = 0; i < count; i++) {
    const from = i * CONTACT_BYTES;
    contacts.featureA[i] = view.getUint32(from, true);
    contacts.featureB[i] = view.getUint32(from + 4, true);
    contacts.objectA[i] = view.getUint16(from + 8, true);
    contacts.objectB[i] = view.getUint16(from + 10, true);
    contacts.toi[i] = view.getFloat32(from + 12, true);
    contacts.u[i] = view.getUint16(from + 16, true) / 65535;
    contacts.v[i] = view.getUint16(from + 18, true) / 65535;
    for (let k = 0; k < 3; k++) {
      contacts.normal[3 * i + k] = view.getInt8(from + 20 + k) / 127;
    }
    const flags = view.getUint8(from + 23);
    contacts.kind[i] = flags >> KIND_SHIFT;
    contacts.flags[i] = flags & ((1 << KIND_SHIFT) - 1);
  }
  return contacts;
}

/** Of a question about what is near: two ends each, and how far apart the features are. */
function readLines({ at, count }) {
  const buffer = section(at, LINE_BYTES * count);
  const floats = new Float32Array(buffer);
  const words = new Uint32Array(buffer);
  const lines = {
    count, ends: new Float32Array(6 * count), distance: new Float32Array(count), kind: new Uint8Array(count),
  };
  for (let i = 0; i < count; i++) {
    lines.ends.set(floats.subarray(8 * i, 8 * i + 6), 6 * i);
    lines.distance[i] = floats[8 * i + 6];
    lines.kind[i] = words[8 * i + 7];
  }
  return lines;
}

function readEvents({ at, count }) {
  const words = new Uint32Array(section(at, EVENT_BYTES * count));
  return Array.from({ length: count }, (_, i) => ({
    begin: words[5 * i],
    end: words[5 * i] + words[5 * i + 1],
    kind: words[5 * i + 2] & 255,
    thread: words[5 * i + 2] >>> 8,
    a: words[5 * i + 3],
    b: words[5 * i + 4],
  }));
}

/** The vertices of a feature with so many points; none: there is no such feature. */
export function verticesOf({ mesh }, points, feature) {
  const from = points === 2 ? mesh.edges : mesh.triangles;
  const at = points * feature;
  return points === 1 ? [feature] : at >= from.length ? []
    : points === 2 ? [from[at], from[at + 1]] : [from[at], from[at + 1], from[at + 2]];
}

/** Half the thickness of a feature, in the page's unit: the greatest of its vertices. */
export function radiusOf({ radius, mesh }, vertices) {
  return radius > 0 || !mesh.radii ? radius
    : vertices.reduce((most, vertex) => Math.max(most, mesh.radii[vertex]), 0);
}

/** The weights of the vertices of both features, as common_contact_weights of kinds.h. */
function weightsOf(kind, u, v) {
  return [kind === 1 ? [1 - u, u] : [1], [[1 - u - v, u, v], [1 - v, v], [1 - v, v], [1]][kind]];
}

/** Add to a place, `factor` times, where weighed vertices of an object are between x0 and x1. */
function addPoint(places, place, factor, { x0, x1 }, vertices, weights, t) {
  for (let i = 0; i < vertices.length; i++) {
    for (let k = 0; k < 3; k++) {
      const from = x0[3 * vertices[i] + k];
      places[3 * place + k] += factor * weights[i] * (from + t * (x1[3 * vertices[i] + k] - from));
    }
  }
}

/** Where each contact is on its second feature at t = 0 and t = 1. `reach`: of one at a distance,
 * from there to the nearest point of the first feature when they meet; `share`: which part of
 * that is on the second's side. */
function placeContacts(contacts, objects, separation) {
  const { count } = contacts;
  const [at0, at1, reach] = [0, 1, 2].map(() => new Float64Array(3 * count));
  const share = new Float32Array(count);
  for (let i = 0; i < count; i++) {
    const kind = contacts.kind[i];
    const { points } = KINDS[kind];
    const a = objects[contacts.objectA[i]];
    const b = objects[contacts.objectB[i]];
    const ofA = verticesOf(a, points[0], contacts.featureA[i]);
    const ofB = verticesOf(b, points[1], contacts.featureB[i]);
    const [weightsA, weightsB] = weightsOf(kind, contacts.u[i], contacts.v[i]);
    const own = radiusOf(b, ofB) + separation / 2;
    const both = own + radiusOf(a, ofA) + separation / 2;
    addPoint(at0, i, 1, b, ofB, weightsB, 0);
    addPoint(at1, i, 1, b, ofB, weightsB, 1);
    if (both > 0) {
      addPoint(reach, i, 1, a, ofA, weightsA, contacts.toi[i]);
      addPoint(reach, i, -1, b, ofB, weightsB, contacts.toi[i]);
      share[i] = own / both;
    }
  }
  return { at0, at1, reach, share };
}

/** The whole page's data; throws an Error with a sentence for people. */
export function readData() {
  const text = byId("pccd-meta")?.textContent;
  if (!text) {
    throw new Error("This page is the template alone: pccdctl inspect fills it.");
  }
  const meta = JSON.parse(text);
  if (meta.format !== FORMAT) {
    throw new Error(`This page cannot read data of format ${meta.format}.`);
  }
  const mesh = makeCache((number) => {
    const { vertices, triangles, at, edges: rods, points, radii } = meta.meshes[number];
    const isSmall = vertices <= 65536;
    const buffer = section(at, triangles * 3 * (isSmall ? 2 : 4));
    const corners = isSmall ? new Uint16Array(buffer) : new Uint32Array(buffer);
    const rodEnds = new Uint32Array(section(rods.at, 8 * rods.count));
    let edges = null;
    return {
      number,
      vertexCount: vertices,
      triangles: corners,
      rods: rodEnds, // the ends of edges that no triangle has
      points: new Uint32Array(section(points.at, 4 * points.count)), // that nothing else has
      radii: radii && new Float32Array(section(radii, 4 * vertices)),
      get edges() {
        edges ??= edgesOf(corners, rodEnds, vertices);
        return edges;
      },
    };
  }, Infinity);
  const positions = makeCache(
    (key, place, vertexCount) => readPositions(place, vertexCount, meta.is_rounded), 64);
  const step = makeCache((index) => {
    const from = meta.steps[index];
    const objects = from.objects.map((object) => {
      const its = mesh(object.mesh);
      return {
        handle: object.handle,
        radius: object.radius / meta.unit,
        mesh: its,
        x0: positions(object.x0.join(), object.x0, its.vertexCount),
        x1: positions(object.x1.join(), object.x1, its.vertexCount),
        key1: object.x1.join(),
        key0: object.x0.join(),
      };
    });
    const contacts = readContacts(from.contacts);
    const lines = from.lines ? readLines(from.lines) : null;
    const separation = from.separation / meta.unit;
    return {
      ...from, separation, index, objects, contacts, lines, ...placeContacts(contacts, objects, separation),
    };
  }, STEPS_KEPT);
  return {
    meta,
    step,
    events: makeCache((index) => {
      const { events } = meta.steps[index];
      return events === null ? [] : readEvents(events);
    }, STEPS_KEPT),
    /** Boxes of a level as 12 floats each: low and high at t = 0, low and high at t = 1. */
    boxes(index, tree, level) {
      const levels = meta.steps[index].boxes?.[tree];
      const { at, count } = levels[level];
      return new Float32Array(section(at, BOX_BYTES * count));
    },
  };
}
