/**
 * What a motion tells, move by move: layers and their ticks, how much is still folded, in words.
 *
 * Two shapes can be met on the way: the start, unless it is straight, and the end, if the motion
 * has a goal or begins straight. A joint belongs to a shape until it is first turned after the
 * start, or once it was last turned before the end. A pull turns no joint: there the places of
 * the shape count, and the chain glides out of them one after the other.
 */

import {
  BEND, DOOR, LETTERS, PEEL, PULL, SWING, TILT, dot, joints, momentOf,
} from "./motion.js";

const KINDS = ["peel", "swing", "door", "tilt", "pull", "bend"];
const FEWEST = 10; // moves of a layer that is worth a stop, in a motion of hundreds

/**
 * Per move: `layer` and `visit` (-1 for none), `side` (the end of the chain, 0 or 1) and
 * `acting`, the bar that the strip shows; per moment
 * between two moves: `left` and `made`, the shares of the two shapes (of no meaning if it is `vague`),
 * `inner`, the joints that are in the larger one; and `ticks`, the moments where a layer begins.
 *
 * `visits` are rows [start, stop, piece, depth] of the path that the motion starts at; of a
 * motion whose name is `A to B` the two shapes are called so.
 */
export function storyOf(motion, visits = [], name = "") {
  const { nMoves, nJoints } = motion;
  const last = joints(motion, nMoves);
  const begin = shapeOf(motion, joints(motion, 0), false);
  const end = shapeOf(motion, last, true);
  const vague = motion.rows.some((row) => row.kind === BEND || row.kind === TILT);
  const [, ...names] = /^(.+) to (.+)$/.exec(name) ?? ["", "the first shape", "the second shape"];
  const backwards = begin.nBends === 0 && end.nBends > 0;
  const story = {
    backwards,
    hasGoal: motion.goal !== null && begin.nBends > 0,
    straight: end.nBends === 0,
    vague,
    names,
    begin,
    end,
    nLayers: 0,
    layer: new Int32Array(nMoves).fill(-1),
    visit: new Int32Array(nMoves).fill(-1),
    nVisits: visits.length,
    acting: new Int32Array(nMoves),
    side: Uint8Array.from(motion.rows, sideOf),
  };
  const first = layersOf(joints(motion, 0));
  const second = layersOf(motion.goal ?? last);
  for (let k = 0; k < nMoves; k++) {
    const row = motion.rows[k];
    story.acting[k] = actingBar(row, nJoints, begin.shift[k]);
    const ofEnd = backwards || (story.hasGoal && begin.share[k] === 0);
    if (row.kind === TILT || row.kind === BEND || (ofEnd && end.share[k + 1] === 0)) continue;
    const place = (ofEnd ? end : begin).place[k];
    if (place < 0 || place >= nJoints) continue;
    story.layer[k] = (ofEnd ? second : first).of[place];
    if (!ofEnd) story.visit[k] = visits.findIndex(([from, to]) => from <= place && place < to);
  }
  story.nLayers = backwards ? second.count : first.count;
  story.nLayersOfEnd = second.count;
  story.ticks = ticksOf(motion, story);
  return story;
}

/** The moments where a layer visit begins, in order; neither the first nor the last. */
function ticksOf(motion, { layer, visit, side }) {
  const fewest = Math.max(1, Math.min(FEWEST, Math.floor(motion.nMoves / 40)));
  const open = new Map(); // the run of each end of the chain, for both let go in turn
  const runs = [];
  for (let k = 0; k < motion.nMoves; k++) {
    if (layer[k] < 0) continue;
    const key = visit[k] >= 0 ? `visit ${visit[k]}` : `layer ${layer[k]}`;
    if (open.get(side[k])?.key !== key) {
      open.set(side[k], { key, from: k, count: 0 });
      runs.push(open.get(side[k]));
    }
    open.get(side[k]).count++;
  }
  const found = runs.filter((run) => run.count >= fewest && run.from > 0).map((run) => run.from);
  return [...new Set(found)].sort((a, b) => a - b);
}

/** The end of the chain that a move is about: 0 the first, 1 the last. */
function sideOf({ kind, joint, other }) {
  if (kind === PULL) return joint ? 1 : 0;
  return other > joint ? 1 : 0;
}

function actingBar({ kind, joint, other }, nJoints, shift) {
  if (kind === PEEL || kind === SWING) return Math.min(joint, other);
  if (kind === DOOR) return (joint + other) >> 1;
  if (kind !== PULL) return (nJoints - 1) >> 1;
  // What passes the place where the leading end was at first.
  return Math.max(0, Math.min(nJoints - 2, (joint ? nJoints - 2 : 0) - shift));
}

function layersOf(path) {
  const heights = Array.from({ length: path.length / 3 }, (_, i) => Math.round(path[3 * i + 2]));
  const low = heights.reduce((a, b) => Math.min(a, b));
  const of = heights.map((height) => height - low);
  return { of, count: of.reduce((a, b) => Math.max(a, b)) + 1 };
}

/**
 * How long each place of a shape is kept: of the first pose, or of the last one, seen backwards.
 *
 * `place[k]` is the place that move k lets go of (or reaches), `shift[k]` how far the chain has
 * then glided out of its places, `share[k]` how many of the bends of the shape are there after k
 * moves, `inner[k]` the joints [low, high] that are in it.
 */
function shapeOf(motion, pose, isEnd) {
  const { nMoves, nJoints } = motion;
  const bent = bentJoints(pose);
  const nBends = bent.reduce((sum, is) => sum + is, 0);
  const gone = new Uint8Array(nJoints);
  const share = new Float32Array(nMoves + 1);
  const inner = Array.from({ length: nMoves + 1 });
  const place = new Int32Array(nMoves);
  const shifts = new Int32Array(nMoves);
  let [low, high, shift, left] = [0, nJoints - 1, 0, nBends];
  const letGo = (joint) => {
    if (joint < 0 || joint >= nJoints || gone[joint]) return;
    gone[joint] = 1;
    left -= bent[joint];
  };
  const at = (k) => (isEnd ? nMoves - k : k);
  for (let k = 0; k <= nMoves; k++) {
    share[at(k)] = nBends ? left / nBends : 0;
    inner[at(k)] = [low, high];
    if (k === nMoves) break;
    const index = isEnd ? nMoves - 1 - k : k;
    const row = motion.rows[index];
    const { kind, joint, other } = row;
    shifts[index] = shift;
    if (kind === PULL) {
      const byLast = (joint > 0) !== isEnd;
      place[index] = byLast ? shift : nJoints - 1 + shift;
      letGo(place[index] + (byLast ? 1 : -1)); // at the end of the chain nothing bends
      shift += byLast ? 1 : -1;
      if (byLast) high--;
      else low++;
    } else if (kind === TILT || kind === BEND) {
      left = 0;
      gone.fill(1);
      place[index] = -1;
    } else {
      place[index] = (kind === PEEL ? other : joint) + shift;
      letGo(joint + shift);
      if (kind !== SWING) letGo(other + shift);
      if (kind !== DOOR) [low, high] = narrowed(low, high, row);
    }
  }
  return { nBends, share, inner, place, shift: shifts };
}

/** The joints of low..high that a peel leaves at rest, or the larger part beside a swing. */
function narrowed(low, high, { kind, joint, other }) {
  if (joint < low || joint > high) return [low, high];
  const parts = [[low, joint], [joint, high]];
  const [rest, turned] = other > joint ? parts : parts.reverse();
  return kind === PEEL || rest[1] - rest[0] >= turned[1] - turned[0] ? rest : turned;
}

/** Which joints bend, 0 or 1 each. */
export function bentJoints(pose) {
  const bent = new Uint8Array(pose.length / 3);
  for (let i = 1; i + 1 < bent.length; i++) bent[i] = bendDeg(pose, i) > 0.01 ? 1 : 0;
  return bent;
}

/** How far the chain bends at a joint, in degrees; 0 at its two ends. */
export function bendDeg(pose, joint) {
  if (joint < 1 || joint + 2 > pose.length / 3) return 0;
  const [a, b] = [barOf(pose, joint - 1), barOf(pose, joint)];
  return (Math.acos(Math.max(-1, Math.min(1, dot(a, b)))) * 180) / Math.PI;
}

/** The vector of a bar. */
export function barOf(pose, bar) {
  return [0, 1, 2].map((c) => pose[3 * bar + 3 + c] - pose[3 * bar + c]);
}

/** A bar in words: even ones are blocks, odd ones join two of them. */
export function nameOf(bar) {
  const block = (bar >> 1) + 1;
  if (bar % 2) return `the joint of blocks ${count(block)} and ${count(block + 1)}`;
  return `block ${count(block)}`;
}

/** A direction in words and as the letter of a path. */
export function directionOf(vector) {
  const names = ["east", "north", "up", "west", "south", "down"];
  const axis = vector.findIndex((component) => Math.abs(component) > 0.999);
  if (axis < 0) return "between two directions";
  const code = axis + (vector[axis] < 0 ? 3 : 0);
  return `${names[code]} (${LETTERS[code]})`;
}

/** A whole number with its thousands apart. */
export function count(number) {
  return Math.round(number).toLocaleString("en-GB");
}

/** What happens at a time: [a line on where we are, a line on what turns]. */
export function told(motion, story, time) {
  const { nMoves } = motion;
  if (time <= 0) {
    return [opening(motion, story), nMoves ? "Press Play." : `It has no moves: ${motion.reason}.`];
  }
  if (time >= nMoves) return [closing(motion, story), ending(motion, story)];
  const [move] = momentOf(motion, time);
  const parts = [`Move ${count(move + 1)} of ${count(nMoves)}`];
  if (story.visit[move] >= 0) parts.push(`visit ${story.visit[move] + 1} of ${story.nVisits}`);
  if (story.layer[move] >= 0) {
    const ofEnd = story.hasGoal && story.begin.share[move] === 0;
    const layers = ofEnd ? story.nLayersOfEnd : story.nLayers;
    parts.push(`layer ${story.layer[move] + 1} of ${layers}`);
  }
  if (!story.vague) parts.push(foldedShare(story, move));
  return [parts.join(" · "), explained(motion, move)];
}

function foldedShare({ begin, end, hasGoal, backwards, names }, move) {
  const percent = (share) => `${Math.round(100 * share)} %`;
  if (backwards) return `folded: ${percent(end.share[move])}`;
  if (!hasGoal) return `still folded: ${percent(begin.share[move])}`;
  if (begin.share[move] > 0) return `left of ${names[0]}: ${percent(begin.share[move])}`;
  return `made of ${names[1]}: ${percent(end.share[move])}`;
}

function opening({ nJoints }, { backwards, begin, end }) {
  const blocks = nJoints >> 1 === 1 ? "block" : "blocks";
  const chain = `${count(nJoints >> 1)} ${blocks}, ${count(nJoints)} voxels`;
  if (backwards || (!begin.nBends && !end.nBends)) return `A straight chain of ${chain}`;
  return `Folded: one chain of ${chain}`;
}

function closing({ nMoves, nJoints }, { straight, backwards, hasGoal, names }) {
  const moves = `after ${count(nMoves)} ${nMoves === 1 ? "move" : "moves"}`;
  if (straight) return `Straight ${moves}: a line of ${count(nJoints)} voxels`;
  if (hasGoal) return `There ${moves}: ${names[1]}`;
  return `${backwards ? "Folded" : "Here it ends,"} ${moves}`;
}

function ending({ reason }, { straight, backwards, hasGoal }) {
  if (straight || backwards || hasGoal) return "";
  return `Not straight: ${reason}.`;
}

function explained(motion, move) {
  const { kind, joint, other } = motion.rows[move];
  const bar = nameOf(Math.min(joint, other));
  const does = [
    () => `${bar} turns, and what lies beyond it is carried along`,
    () => `${bar} and all that lies beyond it swing round`,
    () => `the chain from ${nameOf(joint)} to ${nameOf(other - 1)} turns like a door`,
    () => "all blocks turn at once, by the same angle",
    () => `the whole chain glides along itself, led by its ${joint ? "last" : "first"} block`,
    () => `blocks turn about the ${"xyz"[joint]} axis, each evenly`,
  ][kind]();
  return `A ${KINDS[kind]}: ${does}.`;
}
