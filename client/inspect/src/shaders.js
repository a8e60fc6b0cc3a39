// shaders.js - everything that moves is placed between x0 and x1 where it is drawn.

import { Color, DoubleSide, ShaderMaterial, Vector3 } from "three";

const MOVE = `
uniform float t;
attribute vec3 target;
`;

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
  vec4 at = modelViewMatrix * vec4(mix(position, target, t), 1.0);
  seen = at.xyz;
  gl_Position = projectionMatrix * at;
}`,
    fragmentShader: `
uniform vec3 colour;
uniform vec3 up;
uniform float opacity;
varying vec3 seen;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 toEye = normalize(-seen);
  if (dot(normal, toEye) < 0.0) normal = -normal;
  vec3 key = normalize(vec3(0.45, 0.7, 0.55));
  float sky = 0.5 + 0.5 * dot(normal, normalize((viewMatrix * vec4(up, 0.0)).xyz));
  float light = 0.30 + 0.28 * sky + 0.46 * max(dot(normal, key), 0.0);
  float rim = pow(1.0 - max(dot(normal, toEye), 0.0), 3.0);
  vec3 base = gl_FrontFacing ? colour : colour * 0.72 + vec3(0.02, 0.02, 0.05);
  float shine = pow(max(dot(reflect(-key, normal), toEye), 0.0), 24.0);
  vec3 lit = base * light * 1.12 + 0.10 * rim * vec3(0.7, 0.8, 1.0) + 0.07 * shine;
  gl_FragColor = vec4(lit, opacity);
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
  gl_Position = projectionMatrix * modelViewMatrix * vec4(mix(position, target, t), 1.0);
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
attribute vec3 colour;
attribute float toi;
varying vec3 shade;
varying float lit;
void main() {
  vec4 at = modelViewMatrix * vec4(mix(position, target, t), 1.0);
  lit = toi <= t + 1e-6 ? 1.0 : 0.0;
  shade = colour;
  gl_PointSize = size * (lit > 0.5 ? 1.0 : 0.62);
  at.xyz -= normalize(at.xyz) * length(at.xyz) * 0.004;
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
