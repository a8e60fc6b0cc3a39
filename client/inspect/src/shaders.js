// shaders.js - everything that moves is placed where it is drawn, between x0 and x1 or on its arc.

import { BackSide, Color, DoubleSide, ShaderMaterial, Vector3 } from "three";

/** Where something is that is at x0 and x1 at the ends of the step. */
const PLACED = `
uniform float t;
uniform bool turns; // then pose takes x0 to where it is
uniform mat4 pose;
vec3 placed(vec3 x0, vec3 x1) {
  return turns ? (pose * vec4(x0, 1.0)).xyz : mix(x0, x1, t);
}
`;

const MOVE = `${PLACED}
attribute vec3 target;
`;

/** What a surface looks like; normal is towards the eye. */
const LIGHT = `
uniform vec3 colour;
uniform vec3 up;
uniform float opacity;
vec4 lightOf(vec3 base, vec3 normal, vec3 toEye) {
  vec3 key = normalize(vec3(0.45, 0.7, 0.55));
  float sky = 0.5 + 0.5 * dot(normal, normalize((viewMatrix * vec4(up, 0.0)).xyz));
  float light = 0.30 + 0.28 * sky + 0.46 * max(dot(normal, key), 0.0);
  float rim = pow(1.0 - max(dot(normal, toEye), 0.0), 3.0);
  float shine = pow(max(dot(reflect(-key, normal), toEye), 0.0), 24.0);
  return vec4(base * light * 1.12 + 0.10 * rim * vec3(0.7, 0.8, 1.0) + 0.07 * shine, opacity);
}
`;

const SURFACE = `${LIGHT}
varying vec3 seen;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 toEye = normalize(-seen);
  if (dot(normal, toEye) < 0.0) normal = -normal;
  vec3 base = gl_FrontFacing ? colour : colour * 0.72 + vec3(0.02, 0.02, 0.05);
  gl_FragColor = lightOf(base, normal, toEye);
}`;

/** Surfaces: flat shading from the picture itself, both sides lit. */
export function surfaceMaterial(uniforms, colour) {
  return new ShaderMaterial({
    uniforms: { ...uniforms, colour: { value: new Color(...colour) } },
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    vertexShader: `${MOVE}
varying vec3 seen;
void main() {
  vec4 at = modelViewMatrix * vec4(placed(position, target), 1.0);
  seen = at.xyz;
  gl_Position = projectionMatrix * at;
}`,
    fragmentShader: SURFACE,
  });
}

/** Triangles with a thickness: instances of two sides, each moved by the radius along the normal
 * at that time. */
export function sidesMaterial(uniforms, colour) {
  return new ShaderMaterial({
    uniforms: { ...uniforms, colour: { value: new Color(...colour) } },
    side: DoubleSide,
    polygonOffset: true, // along an edge they are in front of what rounds it
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -4,
    vertexShader: `${PLACED}
attribute vec2 corner; // which, and on which side
attribute vec3 a0, b0, c0, a1, b1, c1;
attribute float radius;
varying vec3 seen;
void main() {
  vec3 a = placed(a0, a1), b = placed(b0, b1), c = placed(c0, c1);
  vec3 out_ = cross(b - a, c - a);
  float size = length(out_);
  vec3 at = corner.x < 0.5 ? a : corner.x < 1.5 ? b : c;
  at += size > 0.0 ? corner.y * radius / size * out_ : vec3(0.0);
  vec4 place = modelViewMatrix * vec4(at, 1.0);
  seen = place.xyz;
  gl_Position = projectionMatrix * place;
}`,
    fragmentShader: SURFACE,
  });
}

/** Balls around segments, or around points: instances of a box, in which each pixel looks where
 * its ray meets one. */
export function capsuleMaterial(uniforms, colour) {
  return new ShaderMaterial({
    uniforms: { ...uniforms, colour: { value: new Color(...colour) } },
    side: BackSide, // is seen also from within the box
    vertexShader: `${PLACED}
uniform float pixel; // its size at the distance 1
attribute vec3 from0, to0, from1, to1;
attribute vec2 size; // radius; how many pixels at least
varying vec3 seen;
flat varying vec3 begin, end;
flat varying float radius;
void main() {
  begin = (modelViewMatrix * vec4(placed(from0, from1), 1.0)).xyz;
  end = (modelViewMatrix * vec4(placed(to0, to1), 1.0)).xyz;
  radius = max(size.x, size.y * pixel * -0.5 * (begin.z + end.z));
  vec3 way = end - begin;
  float half_ = 0.5 * length(way);
  way = half_ > 0.0 ? 0.5 * way / half_ : vec3(1.0, 0.0, 0.0);
  vec3 side = normalize(cross(way, abs(way.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
  seen = 0.5 * (begin + end) + position.x * (half_ + radius) * way
    + position.y * radius * side + position.z * radius * cross(way, side);
  gl_Position = projectionMatrix * vec4(seen, 1.0);
}`,
    fragmentShader: `${LIGHT}
uniform mat4 projectionMatrix;
varying vec3 seen;
flat varying vec3 begin, end;
flat varying float radius;
// How far along the ray from the eye the ball is, or -1.
float ball(vec3 ray, vec3 centre) {
  float along = dot(ray, centre);
  vec3 aside = centre - along * ray;
  float square = radius * radius - dot(aside, aside);
  return square < 0.0 ? -1.0 : along - sqrt(square);
}
void main() {
  vec3 ray = normalize(seen);
  vec3 way = end - begin;
  float before = dot(ray, 0.5 * (begin + end)); // from there on, so that little is rounded
  vec3 start = begin - before * ray;
  float square = dot(way, way);
  float far = -1.0;
  vec3 on = begin;
  if (square > 0.0) {
    float turn = dot(way, ray), first = dot(way, start);
    float a = square - turn * turn;
    float b = square * dot(start, ray) - first * turn;
    float c = square * (dot(start, start) - radius * radius) - first * first;
    float root = b * b - a * c;
    if (root < 0.0) discard;
    if (a > 0.0) {
      float away = (b - sqrt(root)) / a;
      float at = (away * turn - first) / square;
      on = begin + at * way;
      far = at < 0.0 || at > 1.0 ? -1.0 : before + away;
    }
  }
  if (far < 0.0) {
    float of_begin = ball(ray, begin), of_end = ball(ray, end);
    bool is_end = of_begin < 0.0 || (of_end >= 0.0 && of_end < of_begin);
    far = is_end ? of_end : of_begin;
    on = is_end ? end : begin;
    if (far < 0.0) discard;
  }
  vec3 at = far * ray;
  vec4 place = projectionMatrix * vec4(at, 1.0);
  gl_FragDepth = 0.5 + 0.5 * place.z / place.w;
  gl_FragColor = lightOf(colour, normalize(at - on), -ray);
}`,
  });
}

/** Lines along edges. */
export function lineMaterial(uniforms, colour, opacity) {
  return new ShaderMaterial({
    uniforms: { ...uniforms, colour: { value: new Color(...colour) }, alpha: { value: opacity } },
    transparent: true,
    depthWrite: false,
    vertexShader: `${MOVE}
void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(placed(position, target), 1.0);
}`,
    fragmentShader: `
uniform vec3 colour;
uniform float alpha;
void main() {
  gl_FragColor = vec4(colour, alpha);
}`,
  });
}

/** Contacts: round points, which light up when their time has come. */
export function pointMaterial(uniforms) {
  return new ShaderMaterial({
    uniforms,
    transparent: true,
    depthWrite: false,
    vertexShader: `${MOVE}
uniform float size;
uniform float pixel; // its size at the distance 1
attribute vec3 colour;
attribute float toi;
varying vec3 shade;
varying float lit;
void main() {
  vec4 at = modelViewMatrix * vec4(placed(position, target), 1.0);
  lit = toi <= t + 1e-6 ? 1.0 : 0.0;
  shade = colour;
  gl_PointSize = size * (lit > 0.5 ? 1.0 : 0.62);
  at.xyz *= 1.0 - max(0.004, 1.5 * size * pixel); // before the surface that it lies on, if tilted
  gl_Position = projectionMatrix * at;
}`,
    fragmentShader: `
uniform vec3 ring;
uniform float rim;
varying vec3 shade;
varying float lit;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  if (r > 1.0) discard;
  float inside = smoothstep(1.0 - rim, 0.88 - rim, r);
  vec3 colour = mix(ring, shade * (1.08 - 0.25 * r), inside);
  float alpha = smoothstep(1.0, 0.88, r) * (lit > 0.5 ? 1.0 : 0.38);
  gl_FragColor = vec4(colour, alpha);
}`,
  });
}

/** From contacts at a distance to their other features; they light up as the points do. */
export function stickMaterial(uniforms) {
  return new ShaderMaterial({
    uniforms,
    transparent: true,
    depthWrite: false,
    vertexShader: `${MOVE}
attribute vec3 colour;
attribute float toi;
varying vec4 shade;
void main() {
  shade = vec4(colour, toi <= t + 1e-6 ? 1.0 : 0.38);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(placed(position, target), 1.0);
}`,
    fragmentShader: `
varying vec4 shade;
void main() {
  gl_FragColor = shade;
}`,
  });
}

/** Boxes: instances of a unit cube's edges between two corners that move. */
export function boxMaterial(uniforms) {
  return new ShaderMaterial({
    uniforms,
    transparent: true,
    depthWrite: false,
    vertexShader: `
uniform float t;
attribute vec3 low0, high0, low1, high1;
void main() {
  vec3 low = mix(low0, low1, t), high = mix(high0, high1, t);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(mix(low, high, position), 1.0);
}`,
    fragmentShader: `
uniform vec3 colour;
uniform float alpha;
void main() {
  gl_FragColor = vec4(colour, alpha);
}`,
  });
}

/** The ground: lines that fade with the distance. */
export function groundMaterial(uniforms) {
  return new ShaderMaterial({
    uniforms,
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
    vertexShader: `
varying vec2 place;
void main() {
  place = uv;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`,
    fragmentShader: `
uniform vec3 colour;
uniform float cells;
varying vec2 place;
float lines(float scale) {
  vec2 at = (place - 0.5) * scale;
  vec2 width = fwidth(at);
  vec2 away = abs(fract(at - 0.5) - 0.5) / max(width, 1e-6);
  return (1.0 - min(min(away.x, away.y), 1.0)) * (1.0 - smoothstep(0.15, 0.6, max(width.x, width.y)));
}
void main() {
  float fade = 1.0 - smoothstep(0.12, 0.5, length(place - 0.5));
  float strength = max(0.55 * lines(cells), lines(cells / 5.0));
  gl_FragColor = vec4(colour, strength * fade * 0.5);
}`,
  });
}

export const upVector = (up) => new Vector3(up === "x" ? 1 : 0, up === "y" ? 1 : 0, up === "z" ? 1 : 0);
