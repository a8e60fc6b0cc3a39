// scene.js - the three-dimensional view: camera, ground, and what is drawn.

import { Color, Group, Matrix4, Mesh, PerspectiveCamera, PlaneGeometry, Ray, Scene, Vector3,
  WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { makeBoxes } from "./boxes.js";
import { contactAt, verticesAt } from "./data.js";
import { colourOf, oncePerFrame } from "./dom.js";
import { makeMarks } from "./marks.js";
import { extentOf, makeObjects } from "./objects.js";
import { groundMaterial, upVector } from "./shaders.js";

const FLY_MS = 450;
const FIT_ROOM = 1.08; // around what is seen
const LEGEND_PART = 0.07; // of the half height: so much higher it is seen, above the legend
const POINT_MAX = 11; // pixels across
const POINT_MIN = 5;
const PICK_PIXELS = { mouse: 14, touch: 30 };
const PICK_SAME = 5; // pixels: contacts of a ring so wide are equally far from the pointer
const FLY_PART = 0.8; // of the distance from which all is seen: the rest is cut at the sides
const LEAST_HEIGHT = 0.05; // radians from straight above or below, where no side is left or right
const CLOSE = 22; // sizes of a contact's features away from it
const CLOSER = 0.6; // of the distance at most, where they are large
const SIDES = Array.from({ length: 27 }, (_, i) => new Vector3(i % 3 - 1, Math.floor(i / 3) % 3 - 1, Math.floor(i / 9) - 1))
  .filter((side) => side.lengthSq() > 0).map((side) => side.normalize());

/** Colours of the style sheet as [r, g, b]. */
function rgbOf(name) {
  const colour = new Color(colourOf(name));
  colour.convertLinearToSRGB();
  return colour.toArray();
}

/** Where the camera looks from at first: a little from above, and aside. */
function viewDirection(up) {
  const direction = { x: [0.42, 1, 0.62], y: [0.62, 0.42, 1], z: [1, 0.62, 0.42] }[up];
  return new Vector3(...direction).normalize();
}

/** Throws where there is no WebGL. `onMove(camera, pin, at)`: after each picture; `at`: where the
 * camera is, for lookFrom ("": where everything is seen). */
export function makeScene(canvas, onMove) {
  const renderer = new WebGLRenderer({ canvas, antialias: true });
  const scene = new Scene();
  const camera = new PerspectiveCamera(38, 1, 0.01, 100);
  let controls = null;
  const uniforms = {
    t: { value: 1 }, pixel: { value: 1e-3 }, size: { value: 12 }, rim: { value: 0 }, opacity: { value: 1 },
    up: { value: upVector("y") }, ring: { value: new Color() }, turns: { value: false }, pose: { value: new Matrix4() },
  };
  const groundUniforms = { colour: { value: new Color() }, cells: { value: 80 } };
  const ground = new Mesh(new PlaneGeometry(1, 1), groundMaterial(groundUniforms));
  const group = new Group();
  const objects = makeObjects(group, uniforms);
  const marks = makeMarks(group, uniforms);
  const boxes = makeBoxes(group, uniforms);
  let flight = null; // {begin, fromTarget, toTarget, fromAt, toAt}
  let extent = null;
  let pin = null; // {step, i, key, isHidden}: what is chosen, and whether it is hidden from the place `key`
  let shown = { hidden: new Set(), opacity: 1 };
  let pointSize = POINT_MAX;
  let isFitted = true; // and nobody has moved the camera since
  ground.renderOrder = -1;
  scene.add(ground, group);
  renderer.outputColorSpace = "srgb-linear"; // colours are what the screen shows

  /** They take what is up from the camera, once. */
  function makeControls() {
    const target = controls?.target ?? new Vector3();
    controls?.dispose();
    controls = new OrbitControls(camera, canvas);
    controls.target.copy(target);
    controls.enableDamping = true;
    controls.dampingFactor = 0.12;
    controls.addEventListener("change", () => draw());
    controls.addEventListener("start", () => {
      isFitted = false;
    });
  }

  function fly(now) {
    const share = Math.min(1, (now - flight.begin) / FLY_MS);
    const eased = share < 0.5 ? 4 * share ** 3 : 1 - (2 - 2 * share) ** 3 / 2;
    controls.target.lerpVectors(flight.fromTarget, flight.toTarget, eased);
    camera.position.lerpVectors(flight.fromAt, flight.toAt, eased);
    flight = share < 1 ? flight : null;
  }

  /** What the camera looks at, and where it is from there: while it glides, at the glide's end. */
  function cameraText() {
    const target = flight?.toTarget ?? controls.target;
    const away = (flight?.toAt ?? camera.position).clone().sub(target);
    return isFitted ? "" : [...target.toArray(), ...away.toArray()].map((x) => Number(x.toPrecision(6))).join();
  }

  const draw = oncePerFrame(() => {
    if (flight) {
      fly(performance.now());
    }
    const moves = controls.update() || flight !== null;
    const away = camera.position.distanceTo(controls.target);
    camera.near = away / 200;
    camera.far = away * 20 + (extent ? 20 * extent.radius : 0);
    camera.updateProjectionMatrix();
    renderer.render(scene, camera);
    onMove(camera, pin && { place: placeOf(pin.step, pin.i, uniforms.t.value), isHidden: isPinHidden(moves) }, cameraText());
    if (moves) {
      draw();
    }
  });
  makeControls();

  function resize() {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (width > 0 && height > 0) {
      renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      uniforms.size.value = pointSize * renderer.getPixelRatio();
      uniforms.pixel.value = 2 * Math.tan((camera.fov * Math.PI) / 360) / height;
      draw();
    }
  }
  new ResizeObserver(resize).observe(canvas);

  function flyTo(target, at, isAtOnce) {
    flight = {
      begin: isAtOnce ? -Infinity : performance.now(),
      fromTarget: controls.target.clone(), toTarget: target,
      fromAt: camera.position.clone(), toAt: at,
    };
    draw();
  }

  /** Where a contact is on the canvas at a time: [x, y] in pixels, and how deep. */
  function placeOf(step, i, t) {
    const at = new Vector3(...contactAt(step, i, t)).project(camera);
    return [((at.x + 1) / 2) * canvas.clientWidth, ((1 - at.y) / 2) * canvas.clientHeight, at.z];
  }

  /** How far from the middle every corner of the box is in the picture. */
  function distanceToSee({ low, high, middle }, direction) {
    const right = new Vector3().crossVectors(camera.up, direction).normalize();
    const above = new Vector3().crossVectors(direction, right);
    const tall = Math.tan((camera.fov * Math.PI) / 360);
    let away = 0;
    for (let corner = 0; corner < 8; corner++) {
      const at = new Vector3(...[0, 1, 2].map((k) => ((corner >> k) & 1 ? high : low)[k])).sub(middle);
      const aside = Math.max(Math.abs(at.dot(right)) / camera.aspect, Math.abs(at.dot(above))) / tall;
      away = Math.max(away, aside + at.dot(direction));
    }
    return away;
  }

  /** The triangles that may hide something within so many pixels of the way from `eye` towards a
   * point: [[corner, corner, corner], ...]; none where one sees through them. */
  function trianglesAround(step, { hidden, opacity }, t, eye, toward, pixels) {
    const objects = opacity < 1 ? [] : step.objects.filter(({ handle }) => !hidden.has(handle));
    const ray = new Ray(eye, toward.clone().sub(eye).normalize());
    const spread = pixels * uniforms.pixel.value; // for each unit of the way from the eye
    const [p, q, r, middle] = Array.from({ length: 4 }, () => new Vector3());
    const found = [];
    for (const object of objects) {
      const at = verticesAt(object, t);
      const { triangles } = object.mesh;
      for (let i = 0; i < triangles.length; i += 3) {
        p.fromArray(at, 3 * triangles[i]);
        q.fromArray(at, 3 * triangles[i + 1]);
        r.fromArray(at, 3 * triangles[i + 2]);
        middle.copy(p).add(q).add(r).divideScalar(3);
        const size = Math.sqrt(Math.max(...[p, q, r].map((corner) => corner.distanceToSquared(middle))));
        const room = size + spread * (middle.distanceTo(eye) + size);
        if (ray.distanceSqToPoint(middle) <= room * room) {
          found.push([p.clone(), q.clone(), r.clone()]);
        }
      }
    }
    return found;
  }

  /** Whether one of these triangles lies between the eye and the dot of a contact, which pointMaterial
   * draws somewhat nearer to the eye. */
  function isBehind(triangles, place, eye) {
    const to = new Vector3(...place).sub(eye);
    const far = to.length() * (1 - Math.max(0.004, 1.5 * uniforms.size.value * uniforms.pixel.value));
    const ray = new Ray(eye, to.normalize());
    const met = new Vector3();
    return triangles.some((corners) =>
      ray.intersectTriangle(...corners, false, met) && met.distanceTo(eye) < far);
  }

  /** Whether a surface hides a contact from an eye. */
  function isHiddenFrom(eye, step, i, t) {
    const place = contactAt(step, i, t);
    return isBehind(trianglesAround(step, shown, t, eye, new Vector3(...place), 0), place, eye);
  }

  /** Whether what is chosen is hidden, as far as was known when the camera last stood. */
  function isPinHidden(moves) {
    const key = [camera.position.toArray(), uniforms.t.value].join();
    if (!moves && pin.key !== key) {
      Object.assign(pin, { key, isHidden: isHiddenFrom(camera.position, pin.step, pin.i, uniforms.t.value) });
    }
    return pin.isHidden;
  }

  const view = {
    draw,
    /** What the light and dark of the page make of the view. */
    dress() {
      scene.background = new Color().setRGB(...rgbOf("view"));
      groundUniforms.colour.value.setRGB(...rgbOf("grid"));
      uniforms.ring.value.setRGB(...rgbOf("ring"));
      draw();
    },
    setTime(t) {
      uniforms.t.value = t;
      objects.setTime(t);
      marks.setTime(t);
      draw();
    },
    /** `thick`: as of showObjects. */
    setExtent(step, up, thick) {
      const box = extentOf(step.objects, thick ? step.separation / 2 : null);
      if (!box) {
        return;
      }
      const middle = new Vector3(...box.low.map((low, k) => (low + box.high[k]) / 2));
      const radius = Math.max(1e-9, new Vector3(...box.high).distanceTo(new Vector3(...box.low)) / 2);
      extent = { ...box, middle, radius };
      view.setUp(up);
    },
    setUp(up) {
      if (!extent) {
        return;
      }
      const axis = { x: 0, y: 1, z: 2 }[up];
      const side = 16 * extent.radius;
      camera.up.copy(upVector(up));
      uniforms.up.value.copy(camera.up);
      ground.position.copy(extent.middle).setComponent(axis, extent.low[axis] - 0.002 * extent.radius);
      ground.scale.set(side, side, 1);
      ground.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), camera.up);
      makeControls();
    },
    /** See everything. */
    fit(up, isAtOnce = false) {
      if (extent) {
        const direction = viewDirection(up);
        const away = FIT_ROOM * distanceToSee(extent, direction);
        const above = upVector(up).addScaledVector(direction, -upVector(up).dot(direction)).normalize();
        const lift = LEGEND_PART * away * Math.tan((camera.fov * Math.PI) / 360);
        const target = extent.middle.clone().addScaledVector(above, -lift);
        isFitted = true;
        flyTo(target, target.clone().addScaledVector(direction, away), isAtOnce);
      }
    },
    /** Look at a contact from a side where no surface hides it, of several from the one that is the
     * least turn away: with the scene around it, or, `isClose`, nearer. */
    flyToContact(step, i, t, size, isClose) {
      const at = new Vector3(...contactAt(step, i, t));
      const direction = camera.position.clone().sub(controls.target).normalize();
      const normal = new Vector3().fromArray(step.contacts.normal, 3 * i);
      if (normal.lengthSq() > 0.25 && normal.dot(direction) < -0.2) {
        normal.negate();
      }
      direction.addScaledVector(normal, 0.6).addScaledVector(camera.up, 0.15).normalize();
      const now = camera.position.distanceTo(controls.target);
      const eyeAt = (side) => {
        const seen = extent ? FLY_PART * distanceToSee({ ...extent, middle: at }, side) : 0;
        const away = isClose ? Math.min(CLOSE * size, CLOSER * now) : Math.max(seen, CLOSE * size);
        return at.clone().addScaledVector(side, away);
      };
      const sides = SIDES.map((side) => side.clone().addScaledVector(direction, 0.3).normalize())
        .sort((a, b) => b.dot(direction) - a.dot(direction));
      const eyes = [direction, ...sides].map(eyeAt);
      isFitted = false;
      flyTo(at, eyes.find((eye) => !isHiddenFrom(eye, step, i, t)) ?? eyes[0]);
    },
    /** Turn around what is looked at, by radians to the side and upwards, and come nearer by a
     * factor below 1: for the keyboard. */
    turn(aside, upwards, factor) {
      const away = camera.position.clone().sub(controls.target);
      const height = away.angleTo(camera.up); // 0: from above, where there is no side
      const right = new Vector3().crossVectors(camera.up, away).normalize();
      const rise = Math.min(height - LEAST_HEIGHT, Math.max(height - Math.PI + LEAST_HEIGHT, upwards));
      away.applyAxisAngle(right, -rise).applyAxisAngle(camera.up, aside).multiplyScalar(factor);
      isFitted = false;
      flyTo(controls.target.clone(), away.add(controls.target), true);
    },
    /** Look from where the camera was; `text` as it was told to onMove. */
    lookFrom(text) {
      const [target, away] = [0, 3].map((from) => new Vector3(...text.split(",").slice(from, from + 3).map(Number)));
      isFitted = false;
      flyTo(target, away.add(target), true);
    },
    /** Which part of the vertices of a step is in the picture. */
    partInSight({ objects }) {
      let [inside, all] = [0, 0];
      const place = new Vector3();
      for (const { x1 } of objects) {
        for (let i = 0; i < x1.length; i += 3) {
          place.fromArray(x1, i).project(camera);
          inside += Math.max(Math.abs(place.x), Math.abs(place.y)) <= 1 && place.z < 1 ? 1 : 0;
          all++;
        }
      }
      return inside / all;
    },
    showObjects(step, options) {
      uniforms.opacity.value = options.opacity;
      shown = options;
      if (pin) {
        pin.key = "";
      }
      objects.show(step, { ...options, wireColour: rgbOf("wire") });
      draw();
    },
    showMarks(step, picked, thick) {
      const sticks = marks.show(step, picked, thick);
      pointSize = Math.min(POINT_MAX, Math.max(POINT_MIN, 13 - 2 * Math.log10(picked.length + 1)));
      uniforms.size.value = pointSize * renderer.getPixelRatio();
      uniforms.rim.value = 0.035 * pointSize - 0.15; // small ones would be all ring
      draw();
      return sticks;
    },
    showLines(step, picked) {
      const count = marks.showLines(step, picked, rgbOf("feature-a"));
      draw();
      return count;
    },
    choose(step, i, size) {
      pin = i >= 0 ? { step, i, key: "", isHidden: false } : null;
      marks.choose(step, i, size, { a: rgbOf("feature-a"), b: rgbOf("feature-b"), normal: rgbOf("normal") });
      draw();
    },
    showBoxes(tree, floats) {
      const count = boxes.show(tree, floats);
      draw();
      return count;
    },
    /** The contact of `picked` that is nearest to a place on the canvas, of those at about the same
     * place the nearest to the eye, and not behind a surface of an object that is not in `hidden`, unless
     * one sees through them; -1: none near. A finger is wider than a mouse. */
    pick(step, { picked, t, hidden, opacity }, x, y, pointer) {
      const reach = PICK_PIXELS[pointer] ?? PICK_PIXELS.mouse;
      const near = picked.map((i) => {
        const [atX, atY, depth] = placeOf(step, i, t);
        return { i, depth, away: Math.hypot(atX - x, atY - y) };
      }).filter(({ depth, away }) => depth < 1 && away < reach)
        .sort((a, b) => Math.floor(a.away / PICK_SAME) - Math.floor(b.away / PICK_SAME) || a.depth - b.depth);
      const toward = new Vector3((2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight, 0.5).unproject(camera);
      const triangles = near.length === 0 ? [] : trianglesAround(step, { hidden, opacity }, t, camera.position, toward, reach);
      return near.find(({ i }) => !isBehind(triangles, contactAt(step, i, t), camera.position))?.i ?? -1;
    },
    /** Where a contact is seen, in pixels of the canvas. */
    placeOf: (step, i, t) => placeOf(step, i, t),
    /** What is seen, as the address of a PNG. */
    picture() {
      renderer.render(scene, camera);
      return canvas.toDataURL("image/png");
    },
    extentRadius: () => extent?.radius ?? 1,
  };
  resize();
  return view;
}
