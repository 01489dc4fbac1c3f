/** What the player says of the judge's verdict, of a moment, of a block, and of the file. */

import { reachOf } from "./flat.js";
import { boxOf } from "./camera.js";
import { momentOf, tokenOf } from "./motion.js";
import { barOf, bendDeg, bentJoints, count, directionOf, nameOf } from "./story.js";

/** The badge beside the name: [text, class, whole sentence]. */
export function badgeOf(certificate) {
  if (!certificate) return ["not judged", "unknown", "This page carries no verdict of the judge."];
  if (certificate.ok) return ["certified", "good", "The judge found this motion free of collisions."];
  return ["refused", "bad", "The judge refused this motion."];
}

/** What the judge says, as lines, and the moments it names: { lines, places }. */
export function verdictOf(certificate) {
  const [, , sentence] = badgeOf(certificate);
  if (!certificate) return { lines: [sentence], places: [] };
  const { ok, reason, where, diameter, max_bend_deg: limit, bend_deg: bend } = certificate;
  const lines = [sentence];
  if (!ok) lines.push(`Why: ${reason}.`);
  lines.push(
    `Judged at every instant of ${count(certificate.moves_checked)} moves, for bars of diameter ` +
      `${short(diameter)} voxels and bends up to ${short(limit)}°.`,
    `Bars two or more apart keep ${short(certificate.clearance)}; ` +
      `the largest bend is ${short(bend)}°.`,
  );
  const extent = certificate.extent.map(short).join(" × ");
  if (!extent.includes("unknown")) lines.push(`All of it takes a box of ${extent} voxels.`);
  const places = [];
  const [at, one, other] = certificate.nearest;
  if (!ok && where >= 0) places.push({ label: "Show where it fails", move: where, bar: -1 });
  if (one >= 0) places.push({ label: `Nearest: bars ${one} and ${other}`, move: at, bar: one });
  const [bending, joint] = certificate.most_bent;
  if (joint >= 0) places.push({ label: `Most bent: joint ${joint}`, move: bending, bar: joint });
  return { lines, places };
}

/** Rows about a moment. */
export function momentRows(motion, story, time, pose) {
  const [move, share] = momentOf(motion, time);
  const { from, to } = boxOf(pose);
  const sides = to.map((side, c) => (side - from[c] + 1).toFixed(1).replace(/\.0$/, ""));
  const rows = [["time", `${time.toFixed(2)} of ${count(motion.nMoves)}`]];
  if (motion.nMoves) rows.push(["move", `${move}: ${tokenOf(motion, move)}, ${percent(share)} made`]);
  rows.push(
    ["joints that bend", count(bentJoints(pose).reduce((sum, is) => sum + is, 0))],
    ["box of the chain", `${sides.join(" × ")} voxels`],
    ["joint 0 is at", triple(pose, 0)],
  );
  return rows;
}

/** Rows about the motion and its file. */
export function fileRows(motion, story, shown) {
  const rows = [
    ["blocks", count(motion.nJoints >> 1)],
    ["bars", `${count(motion.nJoints - 1)}, numbered from 0`],
    ["moves", count(motion.nMoves)],
    ["planned for", `diameter ${motion.diameter}, bends up to ${motion.maxBendDeg}°`],
    ["planner's word", motion.reason || "none"],
  ];
  if (shown.sha256) rows.push(["SHA-256 of its file", shown.sha256]);
  return rows;
}

/** What is said of a picked bar: [name, text]; `seen` turns a direction as the picture does. */
export function aboutBar({ motion, startPose, pose, modes }, bar, seen) {
  const [name, nBlocks] = [nameOf(bar), motion.nJoints >> 1];
  const title = bar % 2 ? name : `${name} of ${count(nBlocks)}`;
  const bend = (joint) => {
    const angle = bendDeg(pose, joint);
    if (joint < 1 || joint > motion.nJoints - 2) return "end of the chain";
    return angle < 0.01 ? "straight" : `bent by ${angle.toFixed(0)}°`;
  };
  const lines = [
    `bar ${bar}, voxels ${triple(startPose, bar)} and ${triple(startPose, bar + 1)}`,
    `pointed ${directionOf(barOf(startPose, bar))} at the start`,
    `points ${directionOf(seen(barOf(pose, bar)))} now`,
    `joint ${bar}: ${bend(bar)}; joint ${bar + 1}: ${bend(bar + 1)}`,
  ];
  for (const { label, values } of modes) {
    if (values) lines.push(`${label}: ${values[bar] === null ? "unknown" : short(values[bar])}`);
  }
  return [title[0].toUpperCase() + title.slice(1), lines.join("\n")];
}

/** How far the chain reaches, in words. */
export function reachText(pose) {
  return `whole chain, ${count(reachOf(pose))} voxels`;
}

function triple(pose, joint) {
  const at = Array.from(pose.subarray(3 * joint, 3 * joint + 3), (x) => Number(x.toFixed(2)));
  return `(${at.join(", ")})`;
}

function short(number) {
  if (number === null) return "unknown";
  return typeof number === "string" ? "any distance" : String(Number(number.toFixed(4)));
}

function percent(share) {
  return `${Math.round(100 * share)} %`;
}
