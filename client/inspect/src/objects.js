// objects.js - the surfaces of a step's objects, with their edges.

import { BufferAttribute, BufferGeometry, LineSegments, Mesh } from "three";

import { colourOfObject } from "./colours.js";
import { lineMaterial, surfaceMaterial } from "./shaders.js";

/** Keeps one surface for each object of the step shown, and changes only what moved. */
export function makeObjects(group, uniforms) {
  let shown = []; // {handle, mesh, key0, key1, surface, wires}

  function make(object, index) {
    const geometry = new BufferGeometry();
    geometry.setIndex(new BufferAttribute(object.mesh.triangles, 1));
    const surface = new Mesh(geometry, surfaceMaterial(uniforms, colourOfObject(index)));
    surface.frustumCulled = false; // its box is of another time
    group.add(surface);
    return { handle: object.handle, mesh: object.mesh.number, surface, wires: null };
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
  }

  function drop(item) {
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
    item.wires = new LineSegments(geometry, lineMaterial(uniforms, colour, 0.22));
    item.wires.frustumCulled = false;
    group.add(item.wires);
  }

  return {
    show(step, { wires, opacity, hidden, wireColour }) {
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
        item.surface.visible = isVisible;
        item.surface.material.transparent = opacity < 1;
        item.surface.material.depthWrite = opacity === 1;
        if (item.wires) {
          item.wires.visible = isVisible && wires;
          item.wires.material.uniforms.colour.value.setRGB(...wireColour);
        }
        return item;
      });
      shown.slice(step.objects.length).forEach(drop);
      shown = kept;
    },
  };
}

/** The box around some objects at both ends: {low, high}, or null without a vertex. */
export function extentOf(objects) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const { x0, x1 } of objects) {
    for (const x of [x0, x1]) {
      for (let i = 0; i < x.length; i++) {
        const k = i % 3;
        low[k] = Math.min(low[k], x[i]);
        high[k] = Math.max(high[k], x[i]);
      }
    }
  }
  return low[0] <= high[0] ? { low, high } : null;
}
