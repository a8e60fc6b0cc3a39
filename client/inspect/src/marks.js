// marks.js - the contacts as points, and the two features of the one that is chosen.

import { BufferAttribute, BufferGeometry, Group, LineSegments, Mesh, Points } from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import { colourOfTime } from "./colours.js";
import { CROSSING, KINDS, contactAt, putContact, vertexAt, verticesOf } from "./data.js";
import { pointMaterial, stickMaterial, surfaceMaterial } from "./shaders.js";

/** The corners of both features of contact `i`: [{object, vertices}, ...]. */
export function featuresOf({ contacts, objects }, i) {
  const { points } = KINDS[contacts.kind[i]];
  return [[contacts.objectA[i], contacts.featureA[i]], [contacts.objectB[i], contacts.featureB[i]]]
    .map(([object, feature], side) => ({
      object: objects[object], vertices: verticesOf(objects[object], points[side], feature),
    }));
}

/** How far apart the features of a contact are when they meet. */
export const apartOf = ({ reach }, i) => Math.hypot(...reach.subarray(3 * i, 3 * i + 3));

const ARC_PARTS = 64; // straight ones, in which the way of a vertex that turns is drawn

/** Vertices of an object at a time. */
const corners = ({ object, vertices }, t) => vertices.flatMap((vertex) => vertexAt(object, vertex, t));

/** The way of a vertex in the step, as ends of segments. */
function wayOf(object, vertex) {
  const parts = object.poseAt ? ARC_PARTS : 1;
  return Array.from({ length: parts }, (_, i) => [i / parts, (i + 1) / parts]).flat()
    .flatMap((t) => vertexAt(object, vertex, t));
}

function geometryOf({ at, target }) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(at, 3));
  geometry.setAttribute("target", new BufferAttribute(target, 3));
  return geometry;
}

/** The head of an arrow from zero to `tip`, as ends of four segments. */
function headOf(tip) {
  const across = [0, 1, 2].map((k) => Math.abs(tip[k])).reduce((least, x, k, all) => (x < all[least] ? k : least), 0);
  const [a, b] = [(across + 1) % 3, (across + 2) % 3];
  const side = [0, 0, 0];
  side[a] = -tip[b];
  side[b] = tip[a];
  const length = Math.hypot(...tip) || 1;
  const other = [0, 1, 2].map((k) => (tip[(k + 1) % 3] * side[(k + 2) % 3] - tip[(k + 2) % 3] * side[(k + 1) % 3]) / length);
  return [side, side.map((x) => -x), other, other.map((x) => -x)]
    .flatMap((way) => [tip, tip.map((x, k) => 0.75 * x + 0.12 * way[k])]);
}

/** Lines some pixels wide, which are the same at any distance. */
function wideLines(colour, width) {
  const material = new LineMaterial({ linewidth: width, depthTest: false, transparent: true });
  material.color.setRGB(...colour);
  const lines = new LineSegments2(new LineSegmentsGeometry(), material);
  lines.frustumCulled = false;
  lines.renderOrder = 3;
  return lines;
}

/** Lines of the picked records of what is near, all in one: by their shares of the greatest
 * distance. */
function nearLines({ ends, toi, kind }, picked, crossingColour) {
  const places = new Float32Array(6 * picked.length);
  const colours = new Float32Array(6 * picked.length);
  picked.forEach((i, place) => {
    const colour = kind[i] === CROSSING ? crossingColour : colourOfTime(toi[i]);
    places.set(ends.subarray(6 * i, 6 * i + 6), 6 * place);
    colours.set([...colour, ...colour], 6 * place);
  });
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(places);
  geometry.setColors(colours);
  const lines = new LineSegments2(geometry,
    new LineMaterial({ linewidth: 2.5, vertexColors: true, depthTest: false, transparent: true }));
  lines.frustumCulled = false;
  lines.renderOrder = 2;
  return lines;
}

/** Points of contacts, [i, part]: the foot of contact `i`, or a part of the way from there to its
 * first feature. Where nothing turns, they go from t = 0 to 1 by themselves; else they are placed at
 * each time. */
function makePoints(step, items) {
  const { reach, contacts, turns } = step;
  const at = new Float32Array(3 * items.length);
  const target = turns ? at : new Float32Array(3 * items.length);
  const colours = new Float32Array(3 * items.length);
  const put = (places, t) => items.forEach(([i, part], place) => {
    putContact(step, i, t, places, place);
    for (let k = 0; k < 3; k++) {
      places[3 * place + k] += part * reach[3 * i + k];
    }
  });
  if (!turns) {
    put(at, 0);
    put(target, 1);
  }
  items.forEach(([i], place) => colours.set(colourOfTime(contacts.toi[i]), 3 * place));
  const geometry = geometryOf({ at, target });
  geometry.setAttribute("colour", new BufferAttribute(colours, 3));
  geometry.setAttribute("toi", new BufferAttribute(Float32Array.from(items, ([i]) => contacts.toi[i]), 1));
  return {
    geometry,
    place(t) {
      if (turns) {
        put(at, t);
        for (const name of ["position", "target"]) {
          geometry.getAttribute(name).needsUpdate = true;
        }
      }
    },
  };
}

export function makeMarks(group, uniforms) {
  const points = new Points(new BufferGeometry(), pointMaterial(uniforms));
  const sticks = new LineSegments(new BufferGeometry(), stickMaterial(uniforms));
  const chosen = new Group();
  let near = null;
  let ways = []; // functions that place parts of what is chosen at a time
  let marked = []; // of makePoints: what is shown
  for (const one of [points, sticks]) {
    one.frustumCulled = false;
    one.renderOrder = 2;
  }
  group.add(sticks, points, chosen);

  function clearChosen() {
    for (const part of chosen.children.slice()) {
      chosen.remove(part);
      part.geometry.dispose();
      part.material.dispose();
    }
    ways = [];
  }

  const placeWays = (t) => ways.forEach((place) => place(t));

  /** `ends`: a function of the time. */
  function addLines(ends, colour, width) {
    const lines = wideLines(colour, width);
    ways.push((t) => lines.geometry.setPositions(ends(t)));
    chosen.add(lines);
  }

  function addFace(feature, colour) {
    const at = new Float32Array(9);
    const face = new Mesh(geometryOf({ at, target: at }), surfaceMaterial(uniforms, colour));
    face.material.polygonOffsetFactor = -1;
    face.frustumCulled = false;
    ways.push((t) => {
      at.set(corners(feature, t));
      for (const name of ["position", "target"]) {
        face.geometry.getAttribute(name).needsUpdate = true;
      }
    });
    chosen.add(face);
  }

  /** The features of a contact, drawn over everything, and its normal. */
  function showChosen(step, i, size, colours) {
    const features = featuresOf(step, i);
    const [, b] = features;
    if (features.some(({ vertices }) => vertices.length === 0)) {
      return; // a record that names what there is not
    }
    if (b.vertices.length === 3) {
      addFace(b, colours.b);
    }
    features.forEach((feature, side) => {
      const { length } = feature.vertices;
      const ends = feature.vertices.flatMap((vertex, k) => (length > 2 || k === 0
        ? [vertex, feature.vertices[(k + 1) % length]] : []));
      if (length > 1) {
        addLines((t) => corners({ object: feature.object, vertices: ends }, t), side === 0 ? colours.a : colours.b, 3.5);
      }
    });
    features.forEach(({ object, vertices }, side) => {
      if (vertices.length === 1) {
        const way = wayOf(object, vertices[0]);
        addLines(() => way, side === 0 ? colours.a : colours.b, 2.5);
      }
    });
    const isApart = apartOf(step, i) > 0; // then to where the first feature is
    const tip = [0, 1, 2].map((k) => (isApart ? step.reach[3 * i + k] : size * step.contacts.normal[3 * i + k]));
    const parts = [[0, 0, 0], tip, ...(isApart ? [] : headOf(tip))];
    addLines((t) => {
      const foot = contactAt(step, i, t);
      return parts.flatMap((part) => part.map((x, k) => foot[k] + x));
    }, colours.normal, 3);
  }

  function showMarks(step, picked, isThick) {
    const apart = step.near ? [] : picked.filter((i) => apartOf(step, i) > 0); // has lines
    const items = [[points, picked.map((i) => [i, isThick ? step.share[i] : 0])],
      [sticks, apart.flatMap((i) => [[i, 0], [i, 1]])]];
    marked = items.map(([one, its]) => {
      const part = makePoints(step, its);
      part.place(uniforms.t.value);
      one.geometry.dispose();
      one.geometry = part.geometry;
      one.visible = its.length > 0;
      return part;
    });
    return apart.length;
  }

  return {
    /** `picked`: places of the contacts to be drawn; `isThick`: where thick things touch. Returns
     * how many are at a distance, and so have a stick to their other feature. */
    show: showMarks,
    /** Lines of a question about what is near; returns how many there are. */
    showLines(step, picked, crossingColour) {
      if (near) {
        group.remove(near);
        near.geometry.dispose();
        near.material.dispose();
        near = null;
      }
      if (step.near && picked.length > 0) {
        near = nearLines(step.contacts, picked, crossingColour);
        group.add(near);
      }
      return near ? near.geometry.instanceCount : 0;
    },
    choose(step, i, size, colours) {
      clearChosen();
      if (i >= 0) {
        showChosen(step, i, size, colours);
        placeWays(uniforms.t.value);
      }
    },
    setTime(t) {
      placeWays(t);
      marked.forEach((part) => part.place(t));
    },
  };
}
