// boxes.js - a level of a hierarchy, as the edges of its boxes.

import { BufferAttribute, Color, InstancedBufferGeometry, InstancedInterleavedBuffer,
  InterleavedBufferAttribute, LineSegments } from "three";

import { boxMaterial } from "./shaders.js";

export const TREES = ["triangles", "vertices", "edges", "faces"];
const COLOURS = {
  triangles: [0.30, 0.72, 0.66], vertices: [0.95, 0.62, 0.25],
  edges: [0.42, 0.62, 0.95], faces: [0.30, 0.72, 0.66],
};

// The corners at the ends of the cube's edges: those that differ in one coordinate.
function cubeEdges() {
  const ends = [];
  for (let corner = 0; corner < 8; corner++) {
    for (let axis = 0; axis < 3; axis++) {
      if ((corner & (1 << axis)) === 0) {
        for (const end of [corner, corner | (1 << axis)]) {
          ends.push(end & 1, (end >> 1) & 1, (end >> 2) & 1);
        }
      }
    }
  }
  return new Float32Array(ends);
}

export function makeBoxes(group, uniforms) {
  const own = { ...uniforms, colour: { value: new Color() }, alpha: { value: 0.8 } };
  const lines = new LineSegments(new InstancedBufferGeometry(), boxMaterial(own));
  lines.frustumCulled = false;
  lines.visible = false;
  lines.renderOrder = 1;
  group.add(lines);
  return {
    /** `boxes`: 12 floats each, or null. Returns how many there are. */
    show(tree, boxes) {
      lines.visible = boxes !== null && boxes.length > 0;
      if (!lines.visible) {
        return 0;
      }
      const geometry = new InstancedBufferGeometry();
      const buffer = new InstancedInterleavedBuffer(boxes, 12);
      geometry.setAttribute("position", new BufferAttribute(cubeEdges(), 3));
      ["low0", "high0", "low1", "high1"].forEach((name, i) => {
        geometry.setAttribute(name, new InterleavedBufferAttribute(buffer, 3, 3 * i));
      });
      geometry.instanceCount = boxes.length / 12;
      lines.geometry.dispose();
      lines.geometry = geometry;
      own.colour.value.setRGB(...COLOURS[tree]);
      own.alpha.value = Math.min(0.9, Math.max(0.18, 12 / Math.sqrt(geometry.instanceCount)));
      return geometry.instanceCount;
    },
  };
}
