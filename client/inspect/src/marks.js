// marks.js - the contacts as points, and the two features of the one that is chosen.

import { BufferAttribute, BufferGeometry, Group, Mesh, Points } from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import { colourOfTime } from "./colours.js";
import { pointMaterial, surfaceMaterial } from "./shaders.js";

/** The corners of both features of contact `i`: [{object, vertices}, ...]. */
export function featuresOf(step, i) {
  const { contacts, objects } = step;
  const a = objects[contacts.objectA[i]];
  const b = objects[contacts.objectB[i]];
  const edge = (object, feature) => Array.from(object.mesh.edges.slice(2 * feature, 2 * feature + 2));
  return contacts.kind[i] === 0
    ? [{ object: a, vertices: [contacts.featureA[i]] },
      { object: b, vertices: Array.from(b.mesh.triangles.slice(3 * contacts.featureB[i], 3 * contacts.featureB[i] + 3)) }]
    : [{ object: a, vertices: edge(a, contacts.featureA[i]) },
      { object: b, vertices: edge(b, contacts.featureB[i]) }];
}

/** A place between its two ends. */
export const between = (x0, x1, i, t) =>
  [0, 1, 2].map((k) => x0[3 * i + k] + t * (x1[3 * i + k] - x0[3 * i + k]));

/** Vertices of an object at both ends. */
function corners({ object, vertices }) {
  const [at, target] = [0, 1].map((t) =>
    vertices.flatMap((vertex) => between(object.x0, object.x1, vertex, t)));
  return { at, target };
}

function geometryOf({ at, target }, index = null) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(at), 3));
  geometry.setAttribute("target", new BufferAttribute(Float32Array.from(target), 3));
  geometry.setIndex(index);
  return geometry;
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

const CROSSING = 4; // the kind of an edge that passes through a face

/** All of a question's lines in one: by their shares of the greatest distance. */
function nearLines({ count, ends, distance, kind }, crossingColour) {
  const greatest = distance.reduce((most, length) => Math.max(most, length), 0);
  const colours = new Float32Array(6 * count);
  for (let i = 0; i < count; i++) {
    const colour = kind[i] === CROSSING ? crossingColour
      : colourOfTime(greatest > 0 ? distance[i] / greatest : 0);
    colours.set([...colour, ...colour], 6 * i);
  }
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(ends);
  geometry.setColors(colours);
  const lines = new LineSegments2(geometry,
    new LineMaterial({ linewidth: 2.5, vertexColors: true, depthTest: false, transparent: true }));
  lines.frustumCulled = false;
  lines.renderOrder = 2;
  return lines;
}

export function makeMarks(group, uniforms) {
  const points = new Points(new BufferGeometry(), pointMaterial(uniforms));
  const chosen = new Group();
  let near = null;
  let ways = []; // {lines, at, target}: to be placed at a time
  points.frustumCulled = false;
  points.renderOrder = 2;
  group.add(points, chosen);

  function clearChosen() {
    for (const part of chosen.children.slice()) {
      chosen.remove(part);
      part.geometry.dispose();
      part.material.dispose();
    }
    ways = [];
  }

  function placeWays(t) {
    for (const { lines, at, target } of ways) {
      lines.geometry.setPositions(at.map((x, i) => x + t * (target[i] - x)));
    }
  }

  function addLines({ at, target }, colour, width) {
    const lines = wideLines(colour, width);
    ways.push({ lines, at, target });
    chosen.add(lines);
  }

  /** The features of a contact, drawn over everything, and its normal. */
  function showChosen(step, i, size, colours) {
    const features = featuresOf(step, i);
    const [a, b] = features;
    if (b.vertices.length === 3) {
      const face = new Mesh(geometryOf(corners(b), [0, 1, 2]), surfaceMaterial(uniforms, colours.b));
      face.material.polygonOffsetFactor = -1;
      face.frustumCulled = false;
      chosen.add(face);
    } else if (a.vertices.length === 1) {
      return; // a record that names what there is not
    }
    features.forEach((feature, side) => {
      const { length } = feature.vertices;
      const ends = feature.vertices.flatMap((vertex, k) => (length > 2 || k === 0
        ? [vertex, feature.vertices[(k + 1) % length]] : []));
      if (length > 1) {
        addLines(corners({ object: feature.object, vertices: ends }), side === 0 ? colours.a : colours.b, 3.5);
      }
    });
    if (a.vertices.length === 1) { // the way of the vertex during the step
      const { x0, x1 } = a.object;
      const way = [0, 1].flatMap((t) => between(x0, x1, a.vertices[0], t));
      addLines({ at: way, target: way }, colours.a, 2.5);
    }
    const tip = [0, 1, 2].map((k) => size * step.contacts.normal[3 * i + k]);
    const [at, target] = [0, 1].map((t) => {
      const foot = between(step.at0, step.at1, i, t);
      return [...foot, ...foot.map((x, k) => x + tip[k])];
    });
    addLines({ at, target }, colours.normal, 2);
  }

  return {
    /** `picked`: places of the contacts to be drawn. */
    show(step, picked) {
      const at = new Float32Array(3 * picked.length);
      const target = new Float32Array(3 * picked.length);
      const colour = new Float32Array(3 * picked.length);
      const toi = new Float32Array(picked.length);
      picked.forEach((i, place) => {
        at.set(step.at0.subarray(3 * i, 3 * i + 3), 3 * place);
        target.set(step.at1.subarray(3 * i, 3 * i + 3), 3 * place);
        colour.set(colourOfTime(step.contacts.toi[i]), 3 * place);
        toi[place] = step.contacts.toi[i];
      });
      points.geometry.dispose();
      points.geometry = geometryOf({ at, target });
      points.geometry.setAttribute("colour", new BufferAttribute(colour, 3));
      points.geometry.setAttribute("toi", new BufferAttribute(toi, 1));
      points.visible = picked.length > 0;
    },
    /** Lines of a question about what is near; returns how many there are. */
    showLines(step, crossingColour) {
      if (near) {
        group.remove(near);
        near.geometry.dispose();
        near.material.dispose();
        near = null;
      }
      if (step.lines?.count > 0) {
        near = nearLines(step.lines, crossingColour);
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
    setTime: placeWays,
  };
}
