// solids.js - what has a thickness: rods, points, and triangles where it is asked for.

import { BoxGeometry, BufferAttribute, InstancedBufferAttribute, InstancedBufferGeometry, Mesh } from "three";

import { colourOfObject } from "./colours.js";
import { radiusOf } from "./data.js";
import { capsuleMaterial, sidesMaterial } from "./shaders.js";

const ROD_LEAST = 1.5; // pixels from the middle, or nobody would see it
const POINT_LEAST = 2.5;

/** Instances of `geometry` with arrays {name: [numbers, how many each]}. */
function instances(base, arrays, count) {
  const geometry = new InstancedBufferGeometry();
  geometry.setIndex(base.index);
  for (const [name, attribute] of Object.entries(base.attributes)) {
    geometry.setAttribute(name, attribute);
  }
  for (const [name, [numbers, each]] of Object.entries(arrays)) {
    geometry.setAttribute(name, new InstancedBufferAttribute(numbers, each));
  }
  geometry.instanceCount = count;
  return geometry;
}

/** Copy vertices, one for each instance. */
function placesOf(x, vertices) {
  const places = new Float32Array(3 * vertices.length);
  vertices.forEach((vertex, i) => places.set(x.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
  return [places, 3];
}

/** Balls around segments, or points: `from` and `to` are vertices, `sizes` two numbers each. */
function capsules({ x0, x1 }, { from, to, sizes }) {
  return instances(new BoxGeometry(2, 2, 2), {
    from0: placesOf(x0, from), to0: placesOf(x0, to), from1: placesOf(x1, from), to1: placesOf(x1, to),
    size: [Float32Array.from(sizes), 2],
  }, from.length);
}

/** Rods and points; `gap` is added to every radius. */
function freeOf(object, gap) {
  const { rods, points } = object.mesh;
  const segments = { from: [], to: [], sizes: [] };
  for (let i = 0; i < rods.length; i += 2) {
    segments.from.push(rods[i]);
    segments.to.push(rods[i + 1]);
    segments.sizes.push(radiusOf(object, [rods[i], rods[i + 1]]) + gap, ROD_LEAST);
  }
  for (const point of points) {
    segments.from.push(point);
    segments.to.push(point);
    segments.sizes.push(radiusOf(object, [point]) + gap, POINT_LEAST);
  }
  return segments;
}

const cornersOf = ({ triangles }, i) => [0, 1, 2].map((k) => triangles[3 * i + k]);

/** The edges of triangles, each once, with the greatest radius of its triangles. */
function seamsOf(object, radii) {
  const { mesh } = object;
  const places = new Map();
  const segments = { from: [], to: [], sizes: [] };
  radii.forEach((radius, i) => {
    const corners = cornersOf(mesh, i);
    corners.forEach((p, k) => {
      const q = corners[(k + 1) % 3];
      const key = Math.min(p, q) * mesh.vertexCount + Math.max(p, q);
      const place = places.get(key) ?? segments.from.length;
      if (!places.has(key)) {
        places.set(key, place);
        segments.from.push(p);
        segments.to.push(q);
        segments.sizes.push(0, 0);
      }
      segments.sizes[2 * place] = Math.max(segments.sizes[2 * place], radius);
    });
  });
  return segments;
}

/** Two sides of each triangle. */
function sides({ x0, x1, mesh }, radii) {
  const base = {
    index: new BufferAttribute(new Uint16Array([0, 1, 2, 3, 4, 5]), 1),
    attributes: {
      position: new BufferAttribute(new Float32Array(18), 3), // three asks for one
      corner: new BufferAttribute(new Float32Array([0, 1, 1, 1, 2, 1, 0, -1, 1, -1, 2, -1]), 2),
    },
  };
  const arrays = { radius: [radii, 1] };
  ["a", "b", "c"].forEach((name, k) => {
    const vertices = Array.from(radii, (_, i) => mesh.triangles[3 * i + k]);
    arrays[`${name}0`] = placesOf(x0, vertices);
    arrays[`${name}1`] = placesOf(x1, vertices);
  });
  return instances(base, arrays, radii.length);
}

/** The next object that is seen through is compared with nothing of this one. */
function forgetDepths(renderer) {
  renderer.state.buffers.depth.setMask(true);
  renderer.clearDepth();
}

/** The solids of one object: of its rods and points, and of its triangles. Where they are seen
 * through, depths come first, so that what lies within them is not seen. */
export function makeSolids(group, uniforms, index) {
  const colour = colourOfObject(index);
  const order = 0.5 + index / (index + 2); // each object before the next, all before the boxes
  let parts = [];
  let key = null;

  function drop() {
    for (const part of parts) {
      group.remove(part);
      part.geometry.dispose();
      part.material.dispose();
    }
    parts = [];
  }

  function add(geometry, makeMaterial) {
    for (const isDepth of [true, false]) {
      const part = new Mesh(geometry, makeMaterial(uniforms, colour));
      part.frustumCulled = false; // its box is of nothing
      part.material.colorWrite = !isDepth;
      part.renderOrder = isDepth ? order : order + 1e-6;
      group.add(part);
      parts.push(part);
    }
  }

  return {
    drop,
    /** Whether triangles are drawn: `gap` is null where they are not to be, else what is added
     * to every radius. */
    show(object, gap, { isVisible, opacity }) {
      const radii = gap === null ? new Float32Array(0) : Float32Array.from(
        { length: object.mesh.triangles.length / 3 }, (_, i) => radiusOf(object, cornersOf(object.mesh, i)) + gap);
      const areThick = radii.some((radius) => radius > 0);
      const next = [object.key0, object.key1, object.radius, gap].join();
      if (next !== key) {
        drop();
        key = next;
        const free = freeOf(object, gap ?? 0);
        if (free.from.length > 0) {
          add(capsules(object, free), capsuleMaterial);
        }
        if (areThick) {
          add(sides(object, radii), sidesMaterial);
          add(capsules(object, seamsOf(object, radii)), capsuleMaterial);
        }
      }
      for (const part of parts) {
        const { material } = part;
        const isClear = opacity < 1;
        part.visible = isVisible && (isClear || material.colorWrite);
        material.transparent = isClear;
        material.depthWrite = !isClear || !material.colorWrite;
        part.onAfterRender = () => {};
      }
      if (opacity < 1 && parts.length > 0) {
        parts.at(-1).onAfterRender = forgetDepths;
      }
      return areThick;
    },
  };
}
