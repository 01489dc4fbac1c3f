/** The chain in WebGL2: a quad facing the eye for each bar, a capsule met by a ray in each pixel. */

import { shadeOf } from "./palette.js";

const WIDTH = 1024; // of the textures that hold joints and colours
const THINNEST = 0.9; // radius of a far bar in pixels of the page
export const BACKGROUND = [247, 249, 251];
export const PICKED = [214, 0, 110];

/** Radii of the bars in voxels, [even ones, odd ones]. */
export const STYLES = {
  blocks: [0.43, 0.2],
  printed: [0.17, 0.485],
  bars: [0.485, 0.485],
  lines: [0.12, 0.12],
};

const VERTEX = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D joints, colours;
uniform mat4 matrix;
uniform vec3 eye;
uniform vec2 radii;
uniform float thinnest; // radius that is still seen, at distance 1
uniform int picked;
flat out int bar;
flat out vec3 a, b, colour;
flat out float radius;
out vec3 at;

vec3 joint(int k) { return texelFetch(joints, ivec2(k % ${WIDTH}, k / ${WIDTH}), 0).xyz; }

void main() {
  bar = gl_VertexID >> 2;
  int corner = gl_VertexID & 3;
  vec2 side = vec2(corner == 1 || corner == 2 ? 1. : -1., corner > 1 ? 1. : -1.);
  a = joint(bar);
  b = joint(bar + 1);
  colour = texelFetch(colours, ivec2(bar % ${WIDTH}, bar / ${WIDTH}), 0).rgb;
  vec3 half_bar = (b - a) * .5, middle = a + half_bar, towards = eye - middle;
  float far = length(towards);
  towards /= far;
  radius = max((bar & 1) == 0 ? radii.x : radii.y, thinnest * far);
  if (bar == picked) {
    radius = max(radius * 1.18, 3. * thinnest * far);
    colour = vec3(${PICKED.map((part) => (part / 255).toFixed(4)).join(", ")});
  }
  vec3 along = half_bar - towards * dot(half_bar, towards);
  float reach = length(along);
  vec3 some = abs(towards.z) < .9 ? vec3(0, 0, 1) : vec3(1, 0, 0);
  along = reach > 1e-4 ? along / reach : normalize(cross(towards, some));
  vec3 across = cross(towards, along);
  // Perspective shows a little more of a capsule near by than its outline at the middle.
  float room = 1.02 + (radius + .5) / max(far - radius - .5, .5);
  at = middle + (along * side.x * (reach + radius) + across * side.y * radius) * room;
  gl_Position = matrix * vec4(at, 1);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
flat in int bar;
flat in vec3 a, b, colour;
flat in float radius;
in vec3 at;
uniform vec3 eye, light, zenith;
uniform mat4 matrix;
uniform bool naming; // write the numbers of the bars, to be picked, and not their colours
out vec4 shown;

// Where a ray from p meets a sphere about c, in front of p or behind; 1e9 where it does not.
float sphere(vec3 p, vec3 ray, vec3 c) {
  vec3 o = p - c;
  float h = dot(ray, o), rest = h * h - dot(o, o) + radius * radius;
  return rest < 0. ? 1e9 : -h - sqrt(rest);
}

void main() {
  vec3 ray = normalize(at - eye), axis = b - a, o = at - a;
  float aa = dot(axis, axis), ar = dot(axis, ray), ao = dot(axis, o);
  float square = aa - ar * ar;
  float h = aa * dot(ray, o) - ao * ar;
  float rest = h * h - square * (aa * dot(o, o) - ao * ao - radius * radius * aa);
  if (rest < 0.) discard;
  float t = (-h - sqrt(rest)) / max(square, 1e-6);
  float y = ao + t * ar;
  bool seen_along = square < 1e-6;
  if (seen_along || y <= 0. || y >= aa) {
    t = sphere(at, ray, (seen_along ? ar > 0. : y <= 0.) ? a : b);
    if (t > 1e8) discard;
  }
  vec3 point = at + ray * t;
  vec4 clip = matrix * vec4(point, 1);
  gl_FragDepth = clamp(clip.z / clip.w * .5 + .5, 0., 1.);
  if (naming) {
    int name = bar + 1;
    shown = vec4(name & 255, (name >> 8) & 255, (name >> 16) & 255, 255) / 255.;
    return;
  }
  vec3 normal = (point - a - axis * clamp(dot(point - a, axis) / aa, 0., 1.)) / radius;
  float key = max(dot(normal, light), 0.), sky = .5 + .5 * dot(normal, zenith);
  float facing = max(-dot(normal, ray), 0.);
  float gloss = pow(max(dot(reflect(-light, normal), -ray), 0.), 24.);
  vec3 lit = colour * (.36 + .48 * key + .24 * sky) * mix(.5, 1., smoothstep(0., .5, facing));
  shown = vec4(lit + .12 * gloss, 1);
}`;

/**
 * Draws a chain into a canvas by WebGL2; null where the browser has none.
 *
 * `draw(frame)` takes { pose, camera, colours, style, picked }; `pick(frame, x, y)` says which
 * bar is seen at a point of the canvas, in pixels, -1 for none, and leaves a picture to be drawn.
 */
export function webglScene(canvas, nJoints) {
  const options = { antialias: false, alpha: false, powerPreference: "high-performance" };
  const gl = canvas.getContext("webgl2", options);
  if (!gl) return null;
  const nBars = nJoints - 1;
  const rows = Math.ceil(nJoints / WIDTH);
  const buffer = new Float32Array(4 * WIDTH * rows);
  let parts = built();
  let painted = null;

  function built() {
    const program = programOf(gl);
    gl.bindVertexArray(gl.createVertexArray());
    const index = new Uint32Array(6 * nBars);
    for (let k = 0; k < nBars; k++) index.set([0, 1, 2, 0, 2, 3].map((c) => 4 * k + c), 6 * k);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
    texture(gl, 0, gl.RGBA32F, rows);
    texture(gl, 1, gl.RGBA8, rows);
    const uniforms = {};
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
      const { name } = gl.getActiveUniform(program, k);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    gl.uniform1i(uniforms.joints, 0);
    gl.uniform1i(uniforms.colours, 1);
    gl.enable(gl.DEPTH_TEST);
    return uniforms;
  }

  /** The joints, seen from the target, so that far ones do not cost near ones their precision. */
  function place(pose, [x, y, z]) {
    for (let i = 0, j = 0; i < pose.length; i += 3, j += 4) {
      buffer[j] = pose[i] - x;
      buffer[j + 1] = pose[i + 1] - y;
      buffer[j + 2] = pose[i + 2] - z;
    }
    gl.activeTexture(gl.TEXTURE0);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDTH, rows, gl.RGBA, gl.FLOAT, buffer);
  }

  function paint(colours) {
    if (painted === colours) return;
    painted = colours;
    const bytes = new Uint8Array(4 * WIDTH * rows);
    for (let k = 0; k < nBars; k++) bytes.set(shadeOf(colours, k), 4 * k);
    gl.activeTexture(gl.TEXTURE1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDTH, rows, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  }

  function render({ pose, camera, colours, style, picked }, naming) {
    place(pose, camera.target);
    paint(colours);
    const { right, up, back, eye, matrix, focal } = camera;
    const light = back.map((x, c) => 0.74 * x + 0.53 * up[c] - 0.41 * right[c]);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...(naming ? [0, 0, 0] : BACKGROUND.map((part) => part / 255)), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(parts.matrix, false, matrix);
    gl.uniform3fv(parts.eye, eye);
    gl.uniform3fv(parts.light, light);
    gl.uniform3fv(parts.zenith, camera.zenith);
    gl.uniform2fv(parts.radii, STYLES[style]);
    gl.uniform1f(parts.thinnest, (2 * THINNEST) / (focal * canvas.clientHeight));
    gl.uniform1i(parts.picked, naming ? -1 : picked);
    gl.uniform1i(parts.naming, naming ? 1 : 0);
    gl.drawElements(gl.TRIANGLES, 6 * nBars, gl.UNSIGNED_INT, 0);
  }

  return {
    kind: "webgl",
    draw: (frame) => render(frame, false),
    pick(frame, x, y) {
      const byte = new Uint8Array(4);
      const [column, row] = [Math.round(x), canvas.height - 1 - Math.round(y)];
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(column, row, 1, 1);
      render(frame, true);
      gl.readPixels(column, row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, byte);
      gl.disable(gl.SCISSOR_TEST);
      return (byte[0] | (byte[1] << 8) | (byte[2] << 16)) - 1;
    },
    rebuild() {
      parts = built();
      painted = null;
    },
    destroy: () => gl.getExtension("WEBGL_lose_context")?.loseContext(),
  };
}

function programOf(gl) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`the picture cannot be drawn: ${gl.getProgramInfoLog(program)}`);
  }
  gl.useProgram(program);
  return program;
}

function texture(gl, unit, format, rows) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, WIDTH, rows);
}
