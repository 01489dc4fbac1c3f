/** Where the eye is: an orbit about what is still folded, or about the line that is left. */

import { DIRECTIONS, cross, dot, joints } from "./motion.js";

const FOCAL = 2.4; // half the height of the picture is seen at this distance
const MARGIN = 1.04;
const SAMPLES = 256;
const SPREAD = 5; // samples over which the view moves on
const TURNING = 0.05; // share of the film over which the second shape is turned upright

/**
 * What to look at from time to time, for `focusAt`.
 *
 * The larger of the two shapes, as far as it is there; the whole chain if it never gets long; and
 * the line where neither shape is, for a line is to be seen as one.
 */
export function focusPath(motion, story) {
  const { begin, end } = story;
  const out = new Float32Array(3 * motion.nJoints);
  const shapes = [[begin, 0], [end, motion.nMoves]].filter(([shape]) => shape.nBends);
  const homes = shapes.map(([, time]) => sidesOf(boxOf(joints(motion, time, out))));
  const home = homes.reduce((a, b) => a.map((side, c) => Math.max(side, b[c])), [2, 2, 2]);
  const few = Math.max(8, 0.01 * motion.nJoints);
  const whole = [];
  const raw = [];
  for (let i = 0; i <= SAMPLES; i++) {
    const time = (motion.nMoves * i) / SAMPLES;
    const pose = joints(motion, time, out);
    whole.push(boxOf(pose));
    const parts = shapes.map(([shape]) => shape.inner[Math.round(time)]);
    const [low, high] = parts.reduce((a, b) => (b[1] - b[0] > a[1] - a[0] ? b : a), [0, 0]);
    const line = high - low < few || straightEnd(i, begin, end) ? 1 : 0;
    const least = home.map((side) => 0.6 * side);
    raw.push({ ...(line ? whole[i] : grown(boxOf(pose, low, high), least)), line });
  }
  const compact = Math.max(...whole.flatMap(sidesOf)) < 0.4 * motion.nJoints;
  const seen = raw.map((box, i) => compact
    ? { ...about(whole, i, SPREAD).reduce(union), line: 0 }
    : { ...box, line: Math.max(...about(raw, i, SPREAD).map(({ line }) => line)) });
  return { boxes: seen.map((_, i) => blended(seen, i)), turn: uprightTurn(motion, story) };
}

/** The box to look at in a pose, at a share of the film. */
export function focusAt({ boxes }, share, pose) {
  const at = Math.max(0, Math.min(1, share)) * (boxes.length - 1);
  const box = mixed([boxes[Math.floor(at)], boxes[Math.ceil(at)]], [1 - (at % 1), at % 1]);
  return mixed([box, { ...boxOf(pose), line: 0 }], [1 - box.line, box.line]);
}

/** A vector as it is seen at a share of the film, where the second shape stands upright. */
export function upright({ turn }, share, vector, back = false) {
  if (!turn) return vector;
  const x = Math.max(0, Math.min(1, (share - turn.middle) / TURNING + 0.5));
  const angle = (back ? -1 : 1) * turn.angle * x * x * (3 - 2 * x);
  const along = dot(turn.axis, vector) * (1 - Math.cos(angle));
  const aside = cross(turn.axis, vector);
  return vector.map(
    (v, c) => v * Math.cos(angle) + aside[c] * Math.sin(angle) + turn.axis[c] * along,
  );
}

/** The box of the joints low..high: { from, to }. */
export function boxOf(pose, low = 0, high = pose.length / 3 - 1) {
  const from = [Infinity, Infinity, Infinity];
  const to = [-Infinity, -Infinity, -Infinity];
  for (let i = 3 * low; i <= 3 * high + 2; i++) {
    from[i % 3] = Math.min(from[i % 3], pose[i]);
    to[i % 3] = Math.max(to[i % 3], pose[i]);
  }
  return { from, to };
}

/**
 * The camera of a view { yaw, pitch, zoom, shift } at which a box is just seen at zoom 1.
 *
 * `placed` leads from directions as seen, where up is up, to those of the motion.
 * `right`, `up` and `back` are its axes, `distance` the way from the eye to the target, and
 * `matrix` leads from positions relative to the target to clip space, column by column.
 */
export function cameraOf({ yaw, pitch, zoom, shift }, { from, to }, aspect, placed = (v) => v) {
  const level = Math.cos(pitch);
  const back = placed([level * Math.cos(yaw), level * Math.sin(yaw), Math.sin(pitch)]);
  const right = placed([-Math.sin(yaw), Math.cos(yaw), 0]);
  const up = cross(back, right);
  const half = to.map((x, c) => (x - from[c]) / 2 + 0.5);
  const centre = to.map((x, c) => (x + from[c]) / 2);
  const needed = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => {
    const corner = half.map((side, c) => (k & (1 << c) ? side : -side));
    const [x, y] = [Math.abs(dot(corner, right)) / aspect, Math.abs(dot(corner, up))];
    return dot(corner, back) + MARGIN * FOCAL * Math.max(x, y);
  });
  const distance = Math.max(2, Math.max(...needed) / zoom);
  const target = centre.map((x, c) => x + (right[c] * shift[0] + up[c] * shift[1]) * distance);
  const near = Math.max(0.3, 0.01 * distance);
  const far = 2 * distance + 20000;
  const eye = back.map((x) => x * distance);
  const matrix = new Float32Array(16);
  const [depth, offset] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
  const along = (axis) => -dot(axis, eye);
  for (let c = 0; c < 3; c++) {
    matrix.set([(FOCAL / aspect) * right[c], FOCAL * up[c], depth * back[c], -back[c]], 4 * c);
  }
  const away = along(back);
  matrix.set([(FOCAL / aspect) * along(right), FOCAL * along(up), depth * away + offset, -away], 12);
  const zenith = placed([0, 0, 1]);
  return { right, up, back, zenith, target, eye, distance, matrix, focal: FOCAL };
}

/** Where a point is in the picture, as shares from its upper left corner, and how far away. */
export function spotOf({ matrix: m, target }, point) {
  const [x, y, z] = point.map((p, c) => p - target[c]);
  const [a, b, , depth] = [0, 1, 2, 3].map((r) => m[r] * x + m[r + 4] * y + m[r + 8] * z + m[r + 12]);
  return { across: 0.5 + a / depth / 2, down: 0.5 - b / depth / 2, depth };
}

/** How the last pose turns to the goal, which is upright: { axis, angle, middle }, or null. */
function uprightTurn(motion, { begin, end, backwards }) {
  if (!motion.goal || !end.nBends) return null;
  const last = joints(motion, motion.nMoves);
  const to = [null, null, null];
  for (let i = 0; i + 3 < last.length; i += 3) {
    const [bar, goal] = [last, motion.goal].map((p) => [0, 1, 2].map((c) => p[i + 3 + c] - p[i + c]));
    const axis = bar.findIndex((x) => Math.abs(x) > 0.5);
    to[axis] ??= goal.map((x) => x * Math.sign(bar[axis]));
  }
  const missing = to.indexOf(null);
  if (missing >= 0) to[missing] = cross(to[(missing + 1) % 3] ?? to[0], to[(missing + 2) % 3] ?? to[0]);
  const angle = Math.acos(Math.max(-1, Math.min(1, (to[0][0] + to[1][1] + to[2][2] - 1) / 2)));
  let axis = [to[1][2] - to[2][1], to[2][0] - to[0][2], to[0][1] - to[1][0]];
  // A half turn takes each direction to its mirror image behind the axis.
  if (Math.hypot(...axis) < 0.1) {
    const half = DIRECTIONS.slice(0, 3).map((d, c) => d.map((x, r) => x + to[c][r]));
    axis = half.find((v) => Math.hypot(...v) > 0.1) ?? [0, 0, 1];
  }
  const left = begin.share.indexOf(0);
  const made = end.share.findIndex((share) => share > 0);
  const middle = backwards ? -1 : (left + made) / 2 / motion.nMoves;
  return { axis: axis.map((x) => x / Math.hypot(...axis)), angle, middle };
}

/** Whether a sample is so near to a straight first or last pose that this is to be seen. */
function straightEnd(i, begin, end) {
  return (!end.nBends && i >= SAMPLES - SPREAD) || (!begin.nBends && i <= SPREAD);
}

/** The moments about moment i, as many before as after it; so the first and last stand alone. */
function about(list, i, most) {
  const n = Math.min(most, i, list.length - 1 - i);
  return list.slice(i - n, i + n + 1);
}

/** The mean of the moments about moment i, the nearer the more: it holds what all of them hold. */
function blended(raw, i) {
  const near = about(raw, i, 2 * SPREAD);
  const middle = (near.length - 1) / 2;
  return mixed(near, near.map((_, j) => Math.exp(-(((j - middle) / SPREAD) ** 2))));
}

function mixed(boxes, weights) {
  const total = weights.reduce((a, b) => a + b);
  const mean = (value) => boxes.reduce((sum, box, j) => sum + weights[j] * value(box), 0) / total;
  return {
    from: [0, 1, 2].map((c) => mean((box) => box.from[c])),
    to: [0, 1, 2].map((c) => mean((box) => box.to[c])),
    line: mean((box) => box.line),
  };
}

function union(a, b) {
  return {
    from: a.from.map((x, c) => Math.min(x, b.from[c])),
    to: a.to.map((x, c) => Math.max(x, b.to[c])),
  };
}

function sidesOf({ from, to }) {
  return to.map((x, c) => x - from[c]);
}

/** A box with sides at least so long, about the same centre. */
function grown({ from, to }, sides) {
  const room = sides.map((side, c) => Math.max(0, side - to[c] + from[c]) / 2);
  return { from: from.map((x, c) => x - room[c]), to: to.map((x, c) => x + room[c]) };
}
