// data.js - what pccdctl inspect wrote into the page (client/ctl/inspect/inspect.h).
//
// Each blob is an element with base64 text of what zlib has compressed, which a browser unpacks
// in the background: `load` a step before `step` is asked for it.

import { byId } from "./dom.js";
import { makePose, readJoints } from "./joints.js";

const FORMAT = 8;
const KIND_SHIFT = 6; // of a contact's kind, over its flags
export const PROVED = 1; // enum pccd_contact_flag
export const INITIAL = 2;
export const INSIDE = 4;
const CONTACT_BYTES = 35;
const LINE_BYTES = 48;
const EVENT_BYTES = 20;
const BOX_BYTES = 48;
const STEPS_KEPT = 12; // decoded ones
const BLOBS_KEPT = 24; // unpacked ones

/** By enum pccd_kind, and enum pccd_near_kind: name, short name, and how many points each of the
 * two features has. */
export const KINDS = [
  { name: "vertex-face", id: "vf", points: [1, 3] },
  { name: "edge-edge", id: "ee", points: [2, 2] },
  { name: "vertex-edge", id: "ve", points: [1, 2] },
  { name: "vertex-vertex", id: "vv", points: [1, 1] },
  { name: "edge-face", id: "ef", points: [2, 3] },
];
export const CROSSING = 4; // the kind of an edge that passes through a face
export const FEATURES = ["", "vertex", "edge", "face"]; // by their points
export const EVENT_KINDS = ["step", "refit", "task unit", "subtree", "pairs", "high-level node",
  "tests", "rebuild", "built in the background", "wait", "merge"];

/** The bytes of a blob: base64 text of a zlib stream. */
async function unpack(number) {
  const binary = atob(byId(`pccd-${String(number).padStart(8, "0")}`).textContent);
  const packed = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** A map that forgets what was not used for longest. */
function makeCache(make, kept) {
  const items = new Map();
  return (key) => {
    const item = items.has(key) ? items.get(key) : make(key);
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

function readPositions(section, place, vertexCount, isRounded) {
  if (!isRounded) {
    return new Float32Array(section(place, 12 * vertexCount));
  }
  const buffer = section(place, 24 + 6 * vertexCount);
  const head = new Float32Array(buffer, 0, 6);
  const numbers = new Uint16Array(buffer, 24, 3 * vertexCount);
  return Float32Array.from(numbers, (number, i) => head[i % 3] + head[3 + (i % 3)] * number);
}

/** Columns, so that a hundred thousand contacts stay small. */
function readContacts(section, { at, count }) {
  const buffer = section(at, CONTACT_BYTES * count);
  let used = 0;
  const column = (make, width = 1) => {
    const made = new make(buffer, used, width * count);
    used += made.byteLength;
    return made;
  };
  const toi = column(Float64Array);
  const params = column(Float32Array, 2);
  const made = {
    count, toi,
    u: params.filter((_, i) => i % 2 === 0),
    v: params.filter((_, i) => i % 2 === 1),
    featureA: column(Uint32Array),
    featureB: column(Uint32Array),
    objectA: column(Uint16Array),
    objectB: column(Uint16Array),
    normal: Float32Array.from(column(Int16Array, 3), (part) => part / 32767),
  };
  const flags = column(Uint8Array);
  return { ...made, kind: flags.map((its) => its >> KIND_SHIFT), flags: flags.map((its) => its & ((1 << KIND_SHIFT) - 1)) };
}

/** Records of a question about what is near, as contacts whose time is their part of the greatest
 * distance; `ends`: the nearest points, of a crossing the ends of its edge. */
function readLines(section, { at, count }) {
  const buffer = section(at, LINE_BYTES * count);
  const floats = new Float32Array(buffer);
  const words = new Uint32Array(buffer);
  const of = (array, place, make) => make.from({ length: count }, (_, i) => array[12 * i + place]);
  const distance = of(floats, 6, Float32Array);
  const greatest = distance.reduce((most, length) => Math.max(most, length), 0);
  const ends = new Float32Array(6 * count);
  for (let i = 0; i < count; i++) {
    ends.set(floats.subarray(12 * i, 12 * i + 6), 6 * i);
  }
  return {
    count, ends, distance, greatest,
    toi: distance.map((length) => (greatest > 0 ? length / greatest : 0)),
    kind: of(words, 7, Uint8Array),
    featureA: of(words, 8, Uint32Array),
    featureB: of(words, 9, Uint32Array),
    objectA: Uint16Array.from(of(words, 10, Uint32Array), (both) => both & 0xffff),
    objectB: Uint16Array.from(of(words, 10, Uint32Array), (both) => both >>> 16),
    u: of(floats, 11, Float32Array),
    flags: new Uint8Array(count),
  };
}

function readEvents(section, { at, count }) {
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

/** Put where something of an object is at a time into `places`, as number `place`: it is at number
 * `i` of `from` at t = 0 and of `to` at t = 1. */
function putPlace(poseAt, from, to, i, t, places, place) {
  const m = poseAt?.(t).elements;
  for (let k = 0; k < 3; k++) {
    const x = from[3 * i + k];
    places[3 * place + k] = m ? m[k] * from[3 * i] + m[4 + k] * from[3 * i + 1] + m[8 + k] * from[3 * i + 2] + m[12 + k]
      : x + t * (to[3 * i + k] - x);
  }
  return places;
}

/** Where a vertex of an object is at a time. */
export const vertexAt = ({ poseAt, x0, x1 }, vertex, t) => putPlace(poseAt, x0, x1, vertex, t, [0, 0, 0], 0);

/** Where all of them are: a loop over arrays of one type is several times as fast as calls. */
export function verticesAt({ poseAt, x0, x1 }, t) {
  const m = poseAt?.(t).elements;
  const places = new Float32Array(x0.length);
  for (let i = 0; i < x0.length; i += 3) {
    for (let k = 0; k < 3; k++) {
      places[i + k] = m ? m[k] * x0[i] + m[4 + k] * x0[i + 1] + m[8 + k] * x0[i + 2] + m[12 + k]
        : x0[i + k] + t * (x1[i + k] - x0[i + k]);
    }
  }
  return places;
}

/** Where contact `i` of a step is at a time, on its second feature: number `place` of `places`. */
export const putContact = ({ objects, contacts, at0, at1 }, i, t, places, place) =>
  putPlace(objects[contacts.objectB[i]].poseAt, at0, at1, i, t, places, place);
export const contactAt = (step, i, t) => putContact(step, i, t, [0, 0, 0], 0);

/** Add to a place, `factor` times, where weighed vertices of an object are at a time. */
function addPoint(places, place, factor, object, vertices, weights, t) {
  for (let i = 0; i < vertices.length; i++) {
    const at = vertexAt(object, vertices[i], t);
    for (let k = 0; k < 3; k++) {
      places[3 * place + k] += factor * weights[i] * at[k];
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

/** The same of records of what is near, when nothing moves: a crossing is where its edge passes. */
function placeLines({ count, ends, kind, u }) {
  const [at0, reach] = [0, 1].map(() => new Float64Array(3 * count));
  const normal = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) {
    const isCrossing = kind[i] === CROSSING;
    const way = [0, 1, 2].map((k) => ends[6 * i + k] - ends[6 * i + 3 + k]);
    const length = isCrossing ? 0 : Math.hypot(...way);
    for (let k = 0; k < 3; k++) {
      at0[3 * i + k] = isCrossing ? ends[6 * i + k] - u[i] * way[k] : ends[6 * i + 3 + k];
      reach[3 * i + k] = isCrossing ? 0 : way[k];
      normal[3 * i + k] = length > 0 ? way[k] / length : 0;
    }
  }
  return { at0, at1: at0, reach, normal, share: new Float32Array(count) };
}

/** All places, as [blob, offset], that a step has data at. */
function placesOf(step, meshes) {
  const counted = (of) => (of ? [of.at] : []);
  const ofMesh = ({ at, edges, points, radii }) => [at, edges.at, points.at, ...(radii ? [radii] : [])];
  return [
    ...step.objects.flatMap(({ x0, x1, mesh }) => [x0, x1, ...ofMesh(meshes[mesh])]),
    ...counted(step.contacts), ...counted(step.lines), ...counted(step.events), ...counted(step.joints),
    ...Object.values(step.boxes).flat().map(({ at }) => at),
  ];
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
  if (!("DecompressionStream" in window)) {
    throw new Error("This browser is too old to unpack the page: Chrome 80, Firefox 113 and Safari 16.4 can, and later ones.");
  }
  meta.steps.forEach((step, index) => {
    step.index = index;
  });
  const all = [...meta.steps, ...meta.left_out].sort((a, b) => a.number - b.number);
  const blob = makeCache(unpack, BLOBS_KEPT);
  const meshes = new Map();

  function readMesh(section, number) {
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
  }

  async function readStep(index) {
    const from = meta.steps[index];
    const numbers = [...new Set(placesOf(from, meta.meshes).map(([number]) => number))];
    const bytes = new Map(await Promise.all(numbers.map(async (number) => [number, await blob(number)])));
    const section = ([number, offset], count) => bytes.get(number).slice(offset, offset + count);
    const joints = from.joints ? readJoints(section, from.joints) : [];
    const objects = from.objects.map((object, place) => {
      if (!meshes.has(object.mesh)) {
        meshes.set(object.mesh, readMesh(section, object.mesh));
      }
      const mesh = meshes.get(object.mesh);
      const read = (at) => readPositions(section, at, mesh.vertexCount, meta.is_rounded);
      return {
        handle: object.handle,
        number: object.number, // the same in all steps
        name: object.name ?? `object ${place}`,
        radius: object.radius / meta.unit,
        mesh,
        x0: read(object.x0),
        x1: read(object.x1),
        key1: object.x1.join(),
        key0: object.x0.join(),
        poseAt: object.joint === null ? null : makePose(joints, object.joint, meta),
      };
    });
    const contacts = from.lines ? readLines(section, from.lines) : readContacts(section, from.contacts);
    const separation = from.separation / meta.unit;
    const places = from.lines ? placeLines(contacts) : placeContacts(contacts, objects, separation);
    contacts.normal ??= places.normal;
    return {
      ...from, separation, index, objects, contacts, ...places,
      turns: objects.some(({ poseAt }) => poseAt !== null),
      events: from.events === null ? [] : readEvents(section, from.events),
      /** Boxes of a level as 12 floats each: low and high at t = 0, low and high at t = 1. */
      boxesAt(tree, level) {
        const { at, count } = from.boxes[tree][level];
        return new Float32Array(section(at, BOX_BYTES * count));
      },
    };
  }

  const steps = new Map(); // that were loaded last, the oldest first
  return {
    meta,
    /** What is told of every step that was played, in order, with its records counted by pairs of objects, [a, b,
     * count, ..]; those whose drawing was left out have no `index`, and first_pair in the place of
     * contacts. */
    all,
    /** Make a step ready to be asked for. */
    async load(index) {
      const step = steps.get(index) ?? await readStep(index);
      steps.delete(index);
      steps.set(index, step);
      if (steps.size > STEPS_KEPT) {
        steps.delete(steps.keys().next().value);
      }
    },
    step: (index) => steps.get(index),
  };
}
