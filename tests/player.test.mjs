// Poses and words of the player, beside those that NumPy made of the same motions. Run by
// test_viewer.py, which puts the player's modules and golden.json into the folder LINEUP_PLAYER.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { pathToFileURL } from "node:url";

const folder = process.env.LINEUP_PLAYER;
const module = (name) => import(pathToFileURL(`${folder}/${name}.js`).href);
const { joints, momentOf, readMotion, tokenOf } = await module("motion");
const { bendDeg, bentJoints, storyOf, told } = await module("story");
const { cameraOf, boxOf, focusAt, focusPath, spotOf, upright } = await module("camera");
const { colourModes, shadeOf } = await module("palette");
const { verdictOf } = await module("details");
const golden = JSON.parse(readFileSync(`${folder}/golden.json`, "utf8"));
const motions = {};
for (const [name, { motion }] of Object.entries(golden)) motions[name] = await readMotion(motion);

for (const [name, { poses }] of Object.entries(golden)) {
  test(`${name}: poses are those of kinematics.py, in any order`, () => {
    for (const { time, pose } of poses) {
      const found = joints(motions[name], time);
      assert.equal(found.length, 3 * pose.length);
      pose.flat().forEach((x, i) => assert.ok(Math.abs(found[i] - x) <= 1e-4, `${time} ${i}`));
    }
  });

  test(`${name}: a pose does not depend on what was asked before`, async () => {
    const fresh = await readMotion(golden[name].motion);
    for (const { time } of poses.toReversed()) {
      assert.deepEqual(joints(fresh, time), joints(motions[name], time));
    }
  });

  test(`${name}: bars keep their length`, () => {
    for (const { time } of poses) {
      const pose = joints(motions[name], time);
      for (let i = 0; i + 3 < pose.length; i += 3) {
        const bar = [0, 1, 2].map((c) => pose[i + 3 + c] - pose[i + c]);
        assert.ok(Math.abs(Math.hypot(...bar) - 1) < 1e-4);
      }
    }
  });

  test(`${name}: every move reads back as it was written`, () => {
    const motion = motions[name];
    const tokens = motion.rows.map((_, k) => tokenOf(motion, k));
    assert.equal(tokens.join(" "), golden[name].motion.moves);
  });

  test(`${name}: the camera holds the whole chain `, () => {
    const pose = joints(motions[name], motions[name].nMoves / 2);
    const view = { yaw: 0.7, pitch: 0.3, zoom: 1, shift: [0, 0] };
    const camera = cameraOf(view, boxOf(pose), 1.5);
    for (let i = 0; i < pose.length; i += 3) {
      const { across, down, depth } = spotOf(camera, Array.from(pose.subarray(i, i + 3)));
      assert.ok(depth > 0 && across > 0 && across < 1 && down > 0 && down < 1);
    }
  });

  test(`${name}: shares of the shapes run from all to nothing`, () => {
    const { begin, end, vague } = storyOf(motions[name]);
    assert.equal(vague, /[bt]/.test(golden[name].motion.moves));
    if (vague) return;
    const falls = (shares) => shares.every((share, k) => k === 0 || share <= shares[k - 1]);
    assert.ok(falls(begin.share) && falls(end.share.toReversed()));
    if (begin.nBends) assert.equal(begin.share[0], 1);
    if (end.nBends) assert.equal(end.share.at(-1), 1);
    if (golden[name].ends_straight) assert.equal(begin.share.at(-1), 0);
  });
}

test("moments: the end belongs to the last move", () => {
  assert.deepEqual(momentOf({ nMoves: 3 }, 2.25), [2, 0.25]);
  assert.deepEqual(momentOf({ nMoves: 3 }, 3), [2, 1]);
  assert.deepEqual(momentOf({ nMoves: 3 }, 99), [2, 1]);
  assert.deepEqual(momentOf({ nMoves: 0 }, 0), [0, 0]);
});

test("what bends, by hand", () => {
  const pose = Float32Array.from([0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 2, 1, 1]);
  assert.deepEqual([...bentJoints(pose)], [0, 0, 1, 1, 0]);
  assert.equal(Math.round(bendDeg(pose, 2)), 90);
  assert.equal(bendDeg(pose, 0), 0);
});

const STAIR = {
  format: "lineup-motion", version: 2, origin: [0, 0, 0], letters: "EEUWWU", poses: [],
  moves: "p5+W p2+E", diameter: 1, max_bend_deg: 90, straight: false, reason: "a part of one",
};

test("layers and words of a motion by hand", async () => {
  const motion = await readMotion({ ...STAIR, moves: "p5+W s3+U s2+E", straight: true });
  const story = storyOf(motion, [[0, 3, 0, 0], [3, 6, 1, 0], [6, 7, 2, 0]]);
  assert.equal(story.nLayers, 3);
  assert.deepEqual([...story.layer], [2, 1, 0]);
  assert.deepEqual([...story.visit], [2, 1, 0]);
  assert.deepEqual(story.ticks, [1, 2]);
  assert.deepEqual([...story.side], [1, 1, 1]);
  assert.equal(
    told(motion, story, 0.5).join(" "),
    "Move 1 of 3 · visit 3 of 3 · layer 3 of 3 · still folded: 100 % " +
      "A peel: the joint of blocks 3 and 4 turns, and what lies beyond it is carried along.",
  );
  assert.match(told(motion, story, 3)[0], /^Straight after 3 moves: a line of 7 voxels/);
  assert.match(told(motion, story, 0)[0], /^Folded: one chain of 3 blocks, 7 voxels/);
});

test("the two shapes of a motion are called by its name", async () => {
  const motion = motions.from_shape_to_shape;
  const { nMoves } = motion;
  const named = storyOf(motion, [], "bunny to duck");
  assert.match(told(motion, named, 0.5)[0], /left of bunny: 100 %$/);
  assert.match(told(motion, named, nMoves - 0.5)[0], /made of duck: \d+ %$/);
  assert.equal(told(motion, named, nMoves)[0], `There after ${nMoves} moves: duck`);
  assert.match(told(motion, storyOf(motion, [], "x"), 0.5)[0], /left of the first shape/);
});

test("a motion without moves says why", async () => {
  const motion = await readMotion({ ...STAIR, moves: "" });
  const story = storyOf(motion);
  assert.equal(told(motion, story, 0)[1], "It has no moves: a part of one.");
  assert.deepEqual(story.ticks, []);
  const { from, to } = focusAt(focusPath(motion, story), 0, joints(motion, 0));
  assert.ok([...from, ...to].every(Number.isFinite));
});

test("a motion that stops short says why", async () => {
  const motion = await readMotion(STAIR);
  assert.match(told(motion, storyOf(motion), 2)[1], /^Not straight: a part of one\.$/);
});

test("colours: nothing known is grey, and limits are said", async () => {
  const motion = await readMotion(STAIR);
  const values = [2.5, null, 4, 4, 4, 4];
  const mode = colourModes(motion, joints(motion, 0), { stress: values }).at(-1);
  assert.deepEqual([mode.low, mode.high], ["2.5", "4"]);
  assert.deepEqual(shadeOf(mode, 1), [150, 156, 164]);
  assert.deepEqual(shadeOf(mode, 0), [68, 1, 84]);
  assert.deepEqual(shadeOf(mode, 2), [253, 231, 37]);
});

test("the view moves on without a jump, and ends on the whole line", () => {
  const motion = motions.peel_fold;
  const path = focusPath(motion, storyOf(motion));
  const line = boxOf(joints(motion, motion.nMoves));
  const sides = (box) => box.to.map((x, c) => x - box.from[c]);
  const most = Math.max(...sides(line));
  const focus = (share) => focusAt(path, share, joints(motion, share * motion.nMoves));
  assert.deepEqual([focus(1).from, focus(1).to], [line.from, line.to]);
  for (let i = 0; i < 2000; i++) {
    const [a, b] = [focus(i / 2000), focus((i + 1) / 2000)];
    assert.ok(a.to.every((x, c) => Math.abs(x - b.to[c]) < 0.1 * most));
  }
});

test("the second shape is shown upright, and the first as it is", () => {
  const motion = motions.from_shape_to_shape;
  const focus = focusPath(motion, storyOf(motion));
  const last = joints(motion, motion.nMoves);
  for (let i = 0; i + 3 < last.length; i += 3) {
    const bar = (pose) => [0, 1, 2].map((c) => pose[i + 3 + c] - pose[i + c]);
    const seen = upright(focus, 1, bar(last));
    assert.ok(bar(motion.goal).every((x, c) => Math.abs(x - seen[c]) < 1e-6));
    assert.ok(upright(focus, 1, seen, true).every((x, c) => Math.abs(x - bar(last)[c]) < 1e-6));
    assert.deepEqual(upright(focus, 0, bar(last)), bar(last));
  }
});

const FAULTS = {
  "another format": [{ format: "lineup-path" }, /format is "lineup-path"/],
  "a later version": [{ version: 3 }, /version 3 .* not known/],
  "no letters": [{ letters: "" }, /letters must be/],
  "letters of no direction": [{ letters: "EEX" }, /letters must be/],
  "an origin off the lattice": [{ origin: [0, 0.5, 0] }, /origin/],
  "text that is no move": [{ moves: "p5+W hop" }, /move 1 reads 'hop', which is not a move/],
  "a joint beyond the chain": [{ moves: "p6+W" }, /move 0 .* joints are 0 to 6/],
  "a bar that goes on": [{ moves: "p4+E" }, /move 0 does not turn a bar by 90 degrees/],
  "a bar that was turned already": [{ moves: "p4+U p4+U" }, /move 1 does not turn/],
  "a pose too many": [{ moves: "t0" }, /tilts to pose 0 of 0/],
  "a pose too short": [{ poses: ["EE"] }, /pose 0 has not 6 letters/],
  "a pull straight back": [{ moves: "g+D" }, /straight back/],
  "angles that are not there": [{ moves: "bx0:1" }, /angles that are not there/],
  "a goal of another chain": [{ goal: [[0, 0, 0], "EE"] }, /goal is not a pose/],
};
for (const [name, [change, message]] of Object.entries(FAULTS)) {
  test(`refused: ${name}`, async () => {
    await readMotion(STAIR);
    await assert.rejects(readMotion({ ...STAIR, ...change }), message);
  });
}

test("refused: more or fewer angles than were said, or none that can be read", async () => {
  const { motion } = golden.bends;
  const rows = { ...motion, moves: "" };
  await readMotion(rows);
  for (const n_angles of [motion.n_angles - 1, motion.n_angles + 1]) {
    await assert.rejects(readMotion({ ...rows, n_angles }), /angles are not those of/);
  }
  await assert.rejects(readMotion({ ...rows, angles: motion.angles.slice(0, 40) }), Error);
  await assert.rejects(readMotion({ ...rows, angles: "%" }), Error);
});

test("refused: a move that begins between lattice poses", async () => {
  const motion = { ...golden.bends.motion };
  const [first] = motion.moves.split(" ");
  await assert.rejects(readMotion({ ...motion, moves: `${first} s2+E` }), /between lattice poses/);
  await assert.rejects(readMotion({ ...motion, moves: `${first} by0:1` }), /between lattice poses/);
});

test("refused: nothing at all", () => assert.rejects(readMotion(null), /not a motion/));

test("a verdict names the moment that fails, and what was never judged says so", () => {
  const refused = {
    ok: false, reason: "bars 1 and 5 collide", where: 7, diameter: 0.999, max_bend_deg: 90,
    clearance: 0.2, bend_deg: 90, moves_checked: 8, nearest: [7, 1, 5], most_bent: [-1, -1],
    extent: [3, 4, 5], violations: 0,
  };
  const { lines, places } = verdictOf(refused);
  assert.match(lines.join(" "), /refused.*bars 1 and 5 collide/);
  assert.deepEqual(places.map(({ move }) => move), [7, 7]);
  assert.match(verdictOf(null).lines[0], /no verdict/);
});
