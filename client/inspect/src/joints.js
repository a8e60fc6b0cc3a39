// joints.js - where bodies that turn are in a step, by the rule of struct pccd_joint.

import { Matrix4, Quaternion, Vector3 } from "three";

const JOINT_BYTES = 136;
const NO_JOINT = 0xffffffff; // the world
const KINDS = { TURN: 1, SLIDE: 2, SHIFT: 3, VECTOR: 4 };
const ONE = new Vector3(1, 1, 1);

/** The joints of a step, each after its parent. */
export function readJoints(section, { at, count }) {
  const view = new DataView(section(at, JOINT_BYTES * count));
  return Array.from({ length: count }, (_, i) => {
    const begin = i * JOINT_BYTES;
    const numbers = Array.from({ length: 16 }, (__, k) => view.getFloat64(begin + 8 + 8 * k, true));
    const vector = (from) => new Vector3(...numbers.slice(from, from + 3));
    return {
      kind: view.getUint32(begin, true),
      parent: view.getUint32(begin + 4, true),
      position: vector(0),
      rotation: new Quaternion(...numbers.slice(3, 7)).normalize(),
      axis: vector(7).normalize(),
      from: vector(10),
      to: vector(13),
    };
  });
}

/** Where a joint has its link at a time, as its parent sees it. */
function linkOf({ kind, position, rotation, axis, from, to }, t) {
  const value = from.clone().lerp(to, t);
  const moved = new Matrix4();
  if (kind === KINDS.TURN) {
    moved.makeRotationAxis(axis, value.x);
  } else if (kind === KINDS.VECTOR) {
    const angle = value.length();
    moved.makeRotationAxis(value.normalize(), angle);
  } else if (kind === KINDS.SLIDE) {
    moved.makeTranslation(axis.clone().multiplyScalar(value.x));
  } else if (kind === KINDS.SHIFT) {
    moved.makeTranslation(value);
  }
  return new Matrix4().compose(position, rotation, ONE).multiply(moved);
}

function worldOf(joints, joint, t) {
  const world = linkOf(joints[joint], t);
  for (let at = joints[joint].parent; at !== NO_JOINT; at = joints[at].parent) {
    world.premultiply(linkOf(joints[at], t));
  }
  return world;
}

/** A function of a time, 0 to 1: the matrix that takes what hangs on a joint from where it is at
 * t = 0 to where it is then, both relative to the page's origin and in its unit. */
export function makePose(joints, joint, { origin, unit }) {
  const toWorld = new Matrix4().makeScale(unit, unit, unit).setPosition(...origin);
  const toLink = worldOf(joints, joint, 0).invert().multiply(toWorld);
  const toPage = toWorld.clone().invert();
  let last = { t: -1, pose: null };
  return (t) => {
    if (last.t !== t) {
      last = { t, pose: worldOf(joints, joint, t).premultiply(toPage).multiply(toLink) };
    }
    return last.pose;
  };
}
