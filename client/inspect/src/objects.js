// objects.js - the surfaces of a step's objects, with their edges; rods and points.

import { BufferAttribute, BufferGeometry, LineSegments, Matrix4, Mesh } from "three";

import { colourOfObject } from "./colours.js";
import { verticesAt } from "./data.js";
import { lineMaterial, surfaceMaterial } from "./shaders.js";
import { makeSolids } from "./solids.js";

const TIMES = [0, 1, 2, 3, 4, 5, 6, 7, 8].map((i) => i / 8); // at which the arcs are measured

/** Keeps one surface for each object of the step shown, and changes only what moved. */
export function makeObjects(group, uniforms) {
  let shown = []; // {handle, mesh, own, poseAt, key0, key1, surface, wires, solids}

  function make(object, index) {
    const geometry = new BufferGeometry();
    const own = { ...uniforms, turns: { value: false }, pose: { value: new Matrix4() } };
    geometry.setIndex(new BufferAttribute(object.mesh.triangles, 1));
    const surface = new Mesh(geometry, surfaceMaterial(own, colourOfObject(index)));
    surface.frustumCulled = false; // its box is of another time
    group.add(surface);
    const solids = makeSolids(group, own, index);
    return { handle: object.handle, mesh: object.mesh.number, own, surface, wires: null, solids };
  }

  function turn({ own, poseAt }, t) {
    own.turns.value = poseAt !== null;
    if (poseAt) {
      own.pose.value = poseAt(t);
    }
  }

  function place(item, object) {
    if (item.key0 !== object.key0 || item.key1 !== object.key1) {
      const at = new BufferAttribute(object.x0, 3);
      const target = object.key0 === object.key1 ? at : new BufferAttribute(object.x1, 3);
      for (const geometry of [item.surface.geometry, item.wires?.geometry]) {
        geometry?.setAttribute("position", at);
        geometry?.setAttribute("target", target);
      }
      item.key0 = object.key0;
      item.key1 = object.key1;
    }
    item.poseAt = object.poseAt;
    turn(item, uniforms.t.value);
  }

  function drop(item) {
    item.solids.drop();
    for (const part of [item.surface, item.wires]) {
      if (part) {
        group.remove(part);
        part.geometry.dispose();
        part.material.dispose();
      }
    }
  }

  function addWires(item, object, colour) {
    const geometry = new BufferGeometry();
    geometry.setIndex(new BufferAttribute(object.mesh.edges, 1));
    for (const name of ["position", "target"]) {
      geometry.setAttribute(name, item.surface.geometry.getAttribute(name));
    }
    item.wires = new LineSegments(geometry, lineMaterial(item.own, colour, 0.22));
    item.wires.frustumCulled = false;
    group.add(item.wires);
  }

  return {
    /** `thick`: triangles are drawn with their thickness, and half of the separation. */
    show(step, { wires, opacity, hidden, thick, wireColour }) {
      const kept = step.objects.map((object, index) => {
        const old = shown[index];
        const isSame = old && old.handle === object.handle && old.mesh === object.mesh.number;
        if (old && !isSame) {
          drop(old);
        }
        const item = isSame ? old : make(object, index);
        place(item, object);
        if (wires && !item.wires) {
          addWires(item, object, wireColour);
        }
        const isVisible = !hidden.has(object.handle);
        const isSolid = item.solids.show(object, thick ? step.separation / 2 : null, { isVisible, opacity });
        item.surface.visible = isVisible && !isSolid;
        item.surface.material.transparent = opacity < 1;
        item.surface.material.depthWrite = opacity === 1;
        if (item.wires) {
          item.wires.visible = isVisible && wires && !isSolid;
          item.wires.material.uniforms.colour.value.setRGB(...wireColour);
        }
        return item;
      });
      shown.slice(step.objects.length).forEach(drop);
      shown = kept;
    },
    setTime: (t) => shown.forEach((item) => turn(item, t)),
  };
}

/** The box around some objects at both ends, and between them where they turn, with room for their
 * radii: {low, high}, or null without a vertex. */
export function extentOf(objects, gap) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const object of objects) {
    const { x0, x1, radius, mesh, poseAt } = object;
    const isRound = gap !== null || mesh.rods.length > 0 || mesh.points.length > 0;
    const thick = radius > 0 || !mesh.radii ? radius : mesh.radii.reduce((a, b) => Math.max(a, b), 0);
    const room = isRound ? thick + (gap ?? 0) : 0;
    for (const x of poseAt ? TIMES.map((t) => verticesAt(object, t)) : [x0, x1]) {
      for (let k = 0; k < 3; k++) {
        let [least, most] = [Infinity, -Infinity];
        for (let i = k; i < x.length; i += 3) {
          least = Math.min(least, x[i]);
          most = Math.max(most, x[i]);
        }
        low[k] = Math.min(low[k], least - room);
        high[k] = Math.max(high[k], most + room);
      }
    }
  }
  return low[0] <= high[0] ? { low, high } : null;
}
