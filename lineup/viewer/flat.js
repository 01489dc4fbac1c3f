/** The chain on a 2D canvas: the picture where there is no WebGL, and the inset of the whole. */

import { boxOf } from "./camera.js";
import { momentOf } from "./motion.js";
import { shadeOf } from "./palette.js";
import { BACKGROUND, PICKED, STYLES } from "./scene.js";

const OUTLINE = "rgba(20, 26, 33, 0.55)";
const INK = "rgba(20, 26, 33, 0.85)";
const FRAME = "#c4254b";

/** Draws as `webglScene` does, the far bars first. */
export function flatScene(canvas) {
  const context = canvas.getContext("2d");
  let shown = null;

  function draw({ pose, camera, colours, style, picked }) {
    const { width, height } = canvas;
    const spots = projected(pose, camera, width, height);
    const order = visible(spots, width, height);
    const scale = camera.focal * height; // the width in pixels of a bar of radius 1 at distance 1
    context.fillStyle = rgb(BACKGROUND);
    context.fillRect(0, 0, width, height);
    context.lineCap = "round";
    const widthOf = (k) => {
      const thick = STYLES[style][k % 2] * scale / spots.depth[k];
      const thinnest = (k === picked ? 5 : 1.8) * (width / (canvas.clientWidth || width));
      return Math.max(thinnest, thick * (k === picked ? 1.18 : 1));
    };
    for (const k of order) {
      const wide = widthOf(k);
      context.beginPath();
      context.moveTo(spots.x[k], spots.y[k]);
      context.lineTo(spots.x[k + 1], spots.y[k + 1]);
      if (wide > 4) {
        context.lineWidth = wide;
        context.strokeStyle = OUTLINE;
        context.stroke();
      }
      context.lineWidth = wide > 4 ? 0.78 * wide : wide;
      context.strokeStyle = rgb(k === picked ? PICKED : shadeOf(colours, k));
      context.stroke();
    }
    shown = { spots, order, widthOf };
  }

  return {
    kind: "flat",
    draw,
    pick(frame, x, y) {
      draw(frame);
      const { spots, order, widthOf } = shown;
      const hit = (k) => awayFrom(spots, k, x, y) <= widthOf(k) / 2;
      return order.findLast(hit) ?? -1;
    },
    rebuild() {},
    destroy() {},
  };
}

/** The whole chain, seen along the way of the camera, in a canvas of its own. */
export function drawInset(canvas, { pose, camera, colours, picked }, ratio) {
  const context = canvas.getContext("2d");
  const { width, height } = canvas;
  const { right, up } = camera;
  const nJoints = pose.length / 3;
  const [x, y] = [new Float32Array(nJoints), new Float32Array(nJoints)];
  for (let i = 0, j = 0; i < nJoints; i++, j += 3) {
    x[i] = pose[j] * right[0] + pose[j + 1] * right[1];
    y[i] = -pose[j] * up[0] - pose[j + 1] * up[1] - pose[j + 2] * up[2];
  }
  const [left, wide] = spanOf(x);
  const [top, high] = spanOf(y);
  const scale = 0.9 * Math.min(width / Math.max(wide + 1, 4), height / Math.max(high + 1, 4));
  for (let i = 0; i < nJoints; i++) {
    x[i] = width / 2 + scale * (x[i] - left - wide / 2);
    y[i] = height / 2 + scale * (y[i] - top - high / 2);
  }
  context.clearRect(0, 0, width, height);
  context.lineWidth = Math.max(1.6 * ratio, 0.8 * scale);
  context.lineCap = "round";
  strokeByShade(context, x, y, colours);
  if (picked >= 0) {
    context.fillStyle = rgb(PICKED);
    context.beginPath();
    context.arc((x[picked] + x[picked + 1]) / 2, (y[picked] + y[picked + 1]) / 2, 4 * ratio, 0, 7);
    context.fill();
  }
  frameOf(context, canvas, { camera, scale, left, wide, top, high }, ratio);
}

/** Above each moment, the colour of what moves: of the last end of the chain, below of the first. */
export function drawStrip(canvas, motion, { side, acting, ticks }, colours) {
  const { width, height } = canvas;
  const { nMoves } = motion;
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, width, height);
  const latest = [null, null];
  for (let x = 0, from = 0; x < width && nMoves; x++) {
    const [move] = momentOf(motion, (x / width) * nMoves);
    for (; from <= move; from++) latest[side[from]] = acting[from];
    const rows = [[latest[1] ?? latest[0], 0], [latest[0] ?? latest[1], height / 2]];
    for (const [bar, y] of rows) {
      context.fillStyle = rgb(shadeOf(colours, bar));
      context.fillRect(x, y, 1, height / 2);
    }
  }
  context.fillStyle = INK;
  const wide = Math.max(1, Math.round(height / 14));
  for (const tick of ticks) {
    context.fillRect((tick / nMoves) * width - wide / 2, 0.6 * height, wide, 0.4 * height);
  }
}

/** The longest side of a pose's box, in voxels. */
export function reachOf(pose) {
  const { from, to } = boxOf(pose);
  return Math.max(...to.map((side, c) => side - from[c])) + 1;
}

/** A ring about what the large picture shows, where that is a small part. */
function frameOf(context, { width, height }, { camera, scale, left, wide, top, high }, ratio) {
  const { target, right, up, distance, focal } = camera;
  const radius = (scale * distance) / focal;
  if (radius > 0.4 * Math.min(width, height)) return;
  const along = (axis) => target[0] * axis[0] + target[1] * axis[1] + target[2] * axis[2];
  context.strokeStyle = FRAME;
  context.lineWidth = 1.5 * ratio;
  context.beginPath();
  const [x, y] = [along(right) - left - wide / 2, -along(up) - top - high / 2];
  context.arc(width / 2 + scale * x, height / 2 + scale * y, Math.max(radius, 6 * ratio), 0, 7);
  context.stroke();
}

/** Stroke a line of many colours, one path for each; steps of less than a pixel are joined. */
function strokeByShade(context, x, y, colours) {
  const runs = new Map();
  for (let i = 0, from = 0; i < colours.index.length; i++) {
    const ends = i + 1 === colours.index.length || colours.index[i + 1] !== colours.index[i];
    if (!ends && Math.abs(x[i + 1] - x[from]) + Math.abs(y[i + 1] - y[from]) < 1) continue;
    if (!runs.has(colours.index[i])) runs.set(colours.index[i], { bar: i, path: new Path2D() });
    const { path } = runs.get(colours.index[i]);
    path.moveTo(x[from], y[from]);
    path.lineTo(x[i + 1], y[i + 1]);
    from = i + 1;
  }
  for (const { bar, path } of runs.values()) {
    context.strokeStyle = rgb(shadeOf(colours, bar));
    context.stroke(path);
  }
}

function projected(pose, { matrix: m, target }, width, height) {
  const n = pose.length / 3;
  const spots = { x: new Float32Array(n), y: new Float32Array(n), depth: new Float32Array(n) };
  for (let i = 0, j = 0; i < n; i++, j += 3) {
    const [a, b, c] = [pose[j] - target[0], pose[j + 1] - target[1], pose[j + 2] - target[2]];
    const w = m[3] * a + m[7] * b + m[11] * c + m[15];
    spots.depth[i] = w;
    spots.x[i] = (0.5 + (m[0] * a + m[4] * b + m[8] * c + m[12]) / w / 2) * width;
    spots.y[i] = (0.5 - (m[1] * a + m[5] * b + m[9] * c + m[13]) / w / 2) * height;
  }
  return spots;
}

/** Bars in front of the eye and in the picture, the far ones first. */
function visible({ x, y, depth }, width, height) {
  const order = [];
  const outside = (p, q, size) => Math.max(p, q) < -20 || Math.min(p, q) > size + 20;
  for (let k = 0; k + 1 < x.length; k++) {
    if (Math.min(depth[k], depth[k + 1]) < 0.5) continue;
    if (outside(x[k], x[k + 1], width) || outside(y[k], y[k + 1], height)) continue;
    order.push(k);
  }
  return order.sort((a, b) => depth[b] + depth[b + 1] - depth[a] - depth[a + 1]);
}

function awayFrom({ x, y }, k, px, py) {
  const [dx, dy] = [x[k + 1] - x[k], y[k + 1] - y[k]];
  const along = ((px - x[k]) * dx + (py - y[k]) * dy) / (dx * dx + dy * dy || 1);
  const at = Math.max(0, Math.min(1, along));
  return Math.hypot(px - x[k] - at * dx, py - y[k] - at * dy);
}

function spanOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return [low, high - low];
}

function rgb([red, green, blue]) {
  return `rgb(${red}, ${green}, ${blue})`;
}
