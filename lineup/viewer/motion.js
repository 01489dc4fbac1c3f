/**
 * The motion format of docs/formats.md, and the poses that a motion passes through.
 *
 * The twin of lineup/notation.py and lineup/kinematics.py. Time runs from 0 to the number of
 * moves; between, time k + s is the share s of move k.
 *
 * A state is { first, bars }: the position of joint 0, and the vector of each bar, so that most
 * moves change one bar alone. Lattice states are whole numbers, and stay so.
 */

export const LETTERS = "ENUWSD";
export const DIRECTIONS = [
  [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1],
];

export const PEEL = 0, SWING = 1, DOOR = 2, TILT = 3, PULL = 4, BEND = 5;

const QUARTER = 2 ** 18;
const TICK = (2 * Math.PI) / 2 ** 20;

// Pieces of a track from the one that leads a wave on which the phase is 0 or 1 within 1e-26.
const REACH = 7;

const TOKEN = new RegExp(
  "^(?:([ps])(\\d{1,9})([+-])([ENUWSD])" +
    "|d(\\d{1,9}):(\\d{1,9})([+-])" +
    "|t(\\d{1,9})" +
    "|g([+-])([ENUWSD])" +
    "|b([xyz])(\\d{1,9}):(\\d{1,9}))$",
);

/**
 * A motion from its JSON document, ready to be played.
 *
 * Rejects with an Error of one line that names the first thing wrong: another format or a later
 * version, text that is no move, or a move that cannot be carried out.
 */
export async function readMotion(document) {
  if (document === null || typeof document !== "object") fail("this is not a motion");
  const { format, version, origin, letters } = document;
  if (format !== "lineup-motion") fail(`the format is ${JSON.stringify(format)}, not a motion`);
  if (version !== 1 && version !== 2) fail(`version ${version} of motions is not known here`);
  if (!isPoint(origin)) fail("the origin is not three whole numbers");
  const last = lengthOf(letters, "letters");
  const poses = document.poses ?? [];
  poses.forEach((pose, k) => {
    if (lengthOf(pose, `pose ${k}`) !== last) fail(`pose ${k} has not ${last} letters`);
  });
  const nAngles = document.n_angles ?? 0;
  const angles = await unpacked(document.angles ?? "", nAngles, last);
  const rows = String(document.moves ?? "").split(" ").filter((token) => token)
    .map((token, k) => moveOf(k, token, last, poses.length, nAngles));
  const goal = document.goal ?? null;
  if (goal && (!isPoint(goal[0]) || lengthOf(goal[1], "the goal") !== last)) {
    fail("the goal is not a pose of this chain");
  }
  const motion = {
    nJoints: last + 1,
    nMoves: rows.length,
    rows,
    origin,
    codes: codesOf(letters),
    poses: poses.map(codesOf),
    angles,
    onLattice: angles.map((row) => row.every((angle) => angle % QUARTER === 0)),
    goal: goal && positions(goal[0], codesOf(goal[1])),
    straight: Boolean(document.straight),
    reason: String(document.reason ?? ""),
    diameter: document.diameter,
    maxBendDeg: document.max_bend_deg,
  };
  motion.marks = marked(motion);
  motion.cursor = thawed(motion.marks[0]);
  return motion;
}

/** Joint positions at a time, (3 P) float32: x, y, z of joint 0, of joint 1, and so on. */
export function joints(motion, time, out = new Float32Array(3 * motion.nJoints)) {
  const { first, bars } = stateAt(motion, time);
  let [x, y, z] = first;
  out[0] = x;
  out[1] = y;
  out[2] = z;
  for (let i = 0; i < bars.length; i += 3) {
    out[i + 3] = x += bars[i];
    out[i + 4] = y += bars[i + 1];
    out[i + 5] = z += bars[i + 2];
  }
  return out;
}

/** The move that a time lies in and the share of it that has been made: [move, share]. */
export function momentOf(motion, time) {
  const within = Math.max(0, Math.min(motion.nMoves, time));
  const move = Math.max(0, Math.min(motion.nMoves - 1, Math.floor(within)));
  return [move, within - move];
}

/** A move as its text in the format, for instance `p120+N`. */
export function tokenOf(motion, move) {
  const { kind, joint, other, value } = motion.rows[move];
  if (kind === PEEL || kind === SWING) {
    return (kind === PEEL ? "p" : "s") + joint + (other > joint ? "+" : "-") + LETTERS[value];
  }
  if (kind === DOOR) return `d${joint}:${other}${value > 0 ? "+" : "-"}`;
  if (kind === TILT) return `t${value}`;
  if (kind === PULL) return "g" + (joint ? "+" : "-") + LETTERS[value];
  return `b${"xyz"[joint]}${other}:${value}`;
}

/** The lattice path from `origin` along direction codes, (3 P) int32. */
export function positions(origin, codes) {
  const path = new Int32Array(3 * codes.length + 3);
  path.set(origin);
  codes.forEach((code, i) => {
    for (let c = 0; c < 3; c++) path[3 * i + 3 + c] = path[3 * i + c] + DIRECTIONS[code][c];
  });
  return path;
}

function fail(message) {
  throw new Error(message);
}

function isPoint(value) {
  return Array.isArray(value) && value.length === 3 && value.every(Number.isInteger);
}

function lengthOf(letters, name) {
  if (typeof letters !== "string" || !/^[ENUWSD]+$/.test(letters)) {
    fail(`${name} must be one or more of ${LETTERS}`);
  }
  return letters.length;
}

function codesOf(letters) {
  return Int8Array.from(letters, (letter) => LETTERS.indexOf(letter));
}

function moveOf(k, text, last, nPoses, nAngles) {
  const found = TOKEN.exec(text);
  if (!found) fail(`move ${k} reads '${text.slice(0, 20)}', which is not a move`);
  const [, turn, at, side, to, from, until, way, pose, head, step, axis, before, after] = found;
  const move = (kind, joint, other, value) => ({ kind, joint, other, value });
  if (axis) {
    if (Math.max(+before, +after) >= nAngles) fail(`move ${k} asks for angles that are not there`);
    return move(BEND, "xyz".indexOf(axis), +before, +after);
  }
  if (head) {
    const ends = head === "+" ? [last, 0] : [0, last];
    return move(PULL, ...ends, LETTERS.indexOf(step));
  }
  if (pose) {
    if (+pose >= nPoses) fail(`move ${k} tilts to pose ${pose} of ${nPoses}`);
    return move(TILT, 0, last, +pose);
  }
  const row = turn
    ? move(turn === "p" ? PEEL : SWING, +at, +at + (side === "+" ? 1 : -1), LETTERS.indexOf(to))
    : move(DOOR, +from, +until, way === "+" ? 1 : -1);
  const [low, high] = [Math.min(row.joint, row.other), Math.max(row.joint, row.other)];
  if (low < 0 || high > last || (row.kind === DOOR && row.joint >= row.other)) {
    fail(`move ${k} reads '${text}', but the joints are 0 to ${last}`);
  }
  return row;
}

/** Rows of angles, (n_angles) Int32Array each, from base64 of their compressed differences. */
async function unpacked(text, nRows, nBars) {
  if (!nRows && !text) return [];
  const nBytes = 4 * nRows * nBars;
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(nBytes);
  let filled = 0;
  for (let reader = stream.getReader(); ; ) {
    const { done, value } = await reader.read();
    if (done) break;
    if (filled + value.length > nBytes) fail(`angles are not those of ${nRows} rows`);
    bytes.set(value, filled);
    filled += value.length;
  }
  if (filled !== nBytes) fail(`angles are not those of ${nRows} rows of ${nBars} bars`);
  const view = new DataView(bytes.buffer);
  const rows = [];
  for (let k = 0; k < nRows; k++) {
    const above = rows[k - 1];
    const row = new Int32Array(nBars);
    for (let i = 0; i < nBars; i++) {
      row[i] = view.getInt32(4 * (k * nBars + i), true) + (above ? above[i] : 0);
    }
    rows.push(row);
  }
  return rows;
}

/** States to start from, about as many as there are moves between two of them; all lattice. */
function marked(motion) {
  const stride = Math.ceil(Math.sqrt(motion.nMoves));
  const start = { move: 0, first: Int32Array.from(motion.origin), codes: motion.codes };
  const marks = [start];
  const state = thawed(start);
  let lattice = true;
  for (let k = 0; k < motion.nMoves; k++) {
    const row = motion.rows[k];
    const goesOn = row.kind === BEND && k > 0 && sameBend(row, motion.rows[k - 1]);
    if (!lattice && !goesOn) fail(`move ${k} begins between lattice poses`);
    advance(motion, state, k, 1);
    lattice = row.kind !== BEND || motion.onLattice[row.value];
    if (lattice && k + 1 - marks.at(-1).move >= stride) marks.push(frozen(state, k + 1));
  }
  return marks;
}

function frozen({ first, bars }, move) {
  const codes = new Int8Array(bars.length / 3);
  for (let i = 0; i < codes.length; i++) {
    const axis = bars[3 * i] ? 0 : bars[3 * i + 1] ? 1 : 2;
    codes[i] = axis + (bars[3 * i + axis] < 0 ? 3 : 0);
  }
  return { move, first: Int32Array.from(first), codes };
}

function thawed({ move, first, codes }) {
  const bars = new Float64Array(3 * codes.length);
  codes.forEach((code, i) => (bars[3 * i + (code % 3)] = code < 3 ? 1 : -1));
  return { move, first: Float64Array.from(first), bars };
}

function stateAt(motion, time) {
  const [move, share] = momentOf(motion, time);
  const { first, bars } = stateBefore(motion, move);
  const state = { first: first.slice(), bars: bars.slice() };
  if (motion.nMoves) advance(motion, state, move, share);
  return state;
}

/** The state before a move, which the caller must not change: from the last one, or a mark. */
function stateBefore(motion, move) {
  const { marks } = motion;
  let mark = Math.min(marks.length - 1, Math.floor((move / (motion.nMoves || 1)) * marks.length));
  while (mark + 1 < marks.length && marks[mark + 1].move <= move) mark++;
  while (marks[mark].move > move) mark--;
  if (motion.cursor.move > move || motion.cursor.move < marks[mark].move) {
    motion.cursor = thawed(marks[mark]);
  }
  const { cursor } = motion;
  for (; cursor.move < move; cursor.move++) {
    const [row, next] = [motion.rows[cursor.move], motion.rows[cursor.move + 1]];
    // The next one sets the same bars to angles of its own.
    if (!sameBend(row, next)) advance(motion, cursor, cursor.move, 1);
  }
  return cursor;
}

function sameBend(row, next) {
  return row.kind === BEND && next.kind === BEND && row.joint === next.joint;
}

/** Change a state by the share, 0 to 1, of move k. */
function advance(motion, state, k, share) {
  const row = motion.rows[k];
  const angle = (share * Math.PI) / 2;
  if (row.kind === PEEL || row.kind === SWING) turn(state, row, k, angle);
  else if (row.kind === DOOR) door(state, row, k, angle);
  else if (row.kind === TILT) tilt(state, motion.poses[row.value], angle);
  else if (row.kind === PULL) pull(state, row, k, share);
  else bend(state, row.joint, motion.angles[row.other], motion.angles[row.value], share);
  if (share === 1 && (row.kind !== BEND || motion.onLattice[row.value])) round(state, row);
}

function round({ first, bars }, { kind, joint, other }) {
  if (kind === PULL) return; // whole already
  const alone = kind === PEEL ? 3 * Math.min(joint, other) : -1;
  const [from, to] = alone < 0 ? [0, bars.length] : [alone, alone + 3];
  for (let i = from; i < to; i++) bars[i] = Math.round(bars[i]);
  for (let c = 0; c < 3; c++) first[c] = Math.round(first[c]);
}

function turn({ first, bars }, { kind, joint, other, value }, k, angle) {
  const bar = Math.min(joint, other);
  const outward = other > joint ? 1 : -1;
  const from = [0, 1, 2].map((c) => outward * bars[3 * bar + c]);
  const to = DIRECTIONS[value];
  if (Math.abs(dot(from, to)) > 1e-6) fail(`move ${k} does not turn a bar by 90 degrees`);
  const [low, high] = kind === PEEL ? [bar, bar] : outward > 0 ? [bar, bars.length / 3 - 1] : [0, bar];
  // What is not moved lies behind joint 0 where the start of the chain turns.
  for (let c = 0; c < 3 && outward < 0; c++) {
    for (let i = low; i <= high; i++) first[c] += bars[3 * i + c];
  }
  rotate(bars, low, high, cross(from, to), angle);
  for (let c = 0; c < 3 && outward < 0; c++) {
    for (let i = low; i <= high; i++) first[c] -= bars[3 * i + c];
  }
}

function door({ bars }, { joint, other, value }, k, angle) {
  const chord = [0, 0, 0];
  for (let i = 3 * joint; i < 3 * other; i++) chord[i % 3] += bars[i];
  const length = Math.hypot(...chord);
  if (length < 0.5) fail(`move ${k} turns about a line through one point`);
  rotate(bars, joint, other - 1, chord.map((c) => c / length), value * angle);
}

/** Turn the bars low..high about a unit axis (Rodrigues). */
function rotate(bars, low, high, axis, angle) {
  const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
  const [ax, ay, az] = axis;
  for (let i = 3 * low; i <= 3 * high; i += 3) {
    const x = bars[i], y = bars[i + 1], z = bars[i + 2];
    const along = (ax * x + ay * y + az * z) * (1 - cosine);
    bars[i] = x * cosine + (ay * z - az * y) * sine + ax * along;
    bars[i + 1] = y * cosine + (az * x - ax * z) * sine + ay * along;
    bars[i + 2] = z * cosine + (ax * y - ay * x) * sine + az * along;
  }
}

function tilt({ bars }, codes, angle) {
  const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
  for (let i = 0; i < codes.length; i++) {
    const to = DIRECTIONS[codes[i]];
    const rests = to.every((component, c) => Math.round(bars[3 * i + c]) === component);
    for (let c = 0; c < 3 && !rests; c++) {
      bars[3 * i + c] = bars[3 * i + c] * cosine + to[c] * sine;
    }
  }
}

function bend({ bars }, axis, before, after, share) {
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
  for (let i = 0; i < before.length; i++) {
    if (Math.abs(bars[3 * i + axis]) > 0.5) continue;
    const angle = TICK * ((1 - share) * before[i] + share * after[i]);
    bars[3 * i + u] = Math.cos(angle);
    bars[3 * i + v] = Math.sin(angle);
  }
}

/** Every joint takes the place of the one before it, and the head makes a step. */
function pullWhole({ first, bars }, head, to, k) {
  const last = bars.length - 3;
  const outward = head ? 1 : -1;
  const [from, gone] = head ? [last, 0] : [0, last];
  for (let c = 0; c < 3; c++) first[c] += head ? bars[gone + c] : to[c];
  if (outward * dot(bars.subarray(from, from + 3), to) < -0.5) {
    fail(`move ${k} would pull the chain straight back`);
  }
  if (head) bars.copyWithin(0, 3);
  else bars.copyWithin(3, 0, last);
  for (let c = 0; c < 3; c++) bars[from + c] = outward * to[c];
}

/** The share of a pull: a wave runs from the head to the other end, see kinematics.py. */
function pull({ first, bars }, { joint: head, value }, k, share) {
  const n = bars.length / 3;
  const to = DIRECTIONS[value];
  if (share === 1) return pullWhole({ first, bars }, head, to, k);
  // Where each joint goes, a vector, in the order from the tail to the head.
  const track = new Float64Array(3 * n + 3);
  if (head) track.set(bars);
  else for (let i = 0; i < 3 * n; i++) track[i] = -bars[3 * (n - 1 - Math.floor(i / 3)) + (i % 3)];
  track.set(to, 3 * n);
  const piece = new Int32Array(n + 1);
  for (let i = 1; i <= n; i++) {
    const [a, b] = [3 * i - 3, 3 * i];
    const cosine = track[a] * track[b] + track[a + 1] * track[b + 1] + track[a + 2] * track[b + 2];
    if (cosine < -0.5) fail(`move ${k} would pull the chain straight back`);
    piece[i] = piece[i - 1] + (cosine < 0.5 ? 1 : 0);
  }
  const phase = wave(piece[n] + 1, share);
  for (let i = 0; i <= n; i++) {
    for (let c = 0; c < 3; c++) track[3 * i + c] *= phase[piece[i]];
  }
  const step = (joint, c) => track[3 * (head ? joint : n - joint) + c];
  for (let i = 0; i < n; i++) {
    for (let c = 0; c < 3; c++) bars[3 * i + c] += step(i + 1, c) - step(i, c);
  }
  for (let c = 0; c < 3; c++) first[c] += step(0, c);
}

/** Phases of the straight pieces of a track, the head's last, after a share of a pull. */
function wave(nPieces, share) {
  const low = 1 - Math.SQRT1_2;
  const span = Math.SQRT1_2 - low;
  const travelled = share * (1 + span * (nPieces - 1));
  const k = Math.max(0, Math.min(nPieces - 1, Math.floor((travelled - low) / span)));
  const leader = nPieces - 1 - k;
  const phase = new Float64Array(nPieces).fill(1, leader);
  phase[leader] = Math.max(0, Math.min(1, travelled - span * k));
  for (let i = leader + 1; i < Math.min(leader + REACH, nPieces); i++) {
    phase[i] = Math.sqrt(phase[i - 1] * (2 - phase[i - 1]));
  }
  for (let i = leader - 1; i > Math.max(leader - REACH, -1); i--) {
    phase[i] = phase[i + 1] ** 2 / (1 + Math.sqrt(1 - phase[i + 1] ** 2));
  }
  return phase;
}

export function dot(p, q) {
  return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

export function cross(p, q) {
  return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
}
