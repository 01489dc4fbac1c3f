/**
 * The motion player: one page that works offline, and a widget in JupyterLab.
 *
 * `shown` is what a page carries (docs/formats.md): { name, sha256, visits, certificate, colours,
 * motion }. The motion is kept as moves; each picture is computed from them.
 */

import { boxOf, cameraOf, focusAt, focusPath, spotOf, upright } from "./camera.js";
import { controls, describe, element, fillLegend, icon } from "./controls.js";
import { aboutBar, badgeOf, fileRows, momentRows, reachText, verdictOf } from "./details.js";
import { drawInset, drawStrip, flatScene } from "./flat.js";
import { listen, listenToView } from "./gestures.js";
import { joints, readMotion } from "./motion.js";
import { colourModes } from "./palette.js";
import { webglScene } from "./scene.js";
import { count, storyOf, told } from "./story.js";

const FILM_SECONDS = 60;
const MOVE_SECONDS = 1.5; // at most, at first
const SLOW_MS = 50; // a frame; above it the picture gets coarser
const QUALITIES = [1, 0.7, 0.5];
const STILL_MS = 160; // without a change, before the picture is drawn finer
const HOME_VIEW = { pitch: 0.42, zoom: 1, shift: [0, 0] };

/** Show a motion in an element; resolves to the player, or to null where it says what is wrong. */
export async function startPlayer(root, shown, options = {}) {
  try {
    const motion = await readMotion(shown.motion);
    root.player = new Player(root, shown, motion, options);
    return root.player;
  } catch (error) {
    root.replaceChildren(element("p", `This motion cannot be played: ${error.message}`));
    root.firstChild.className = "lineup-player-error";
    root.firstChild.setAttribute("role", "alert");
    return null;
  }
}

/** Show the motion that a page carries as JSON text. */
export async function openPage(root, text) {
  let shown;
  try {
    shown = JSON.parse(text);
  } catch {
    shown = { motion: null };
  }
  return startPlayer(root, shown ?? {}, { page: true });
}

export class Player {
  constructor(root, shown, motion, options) {
    Object.assign(this, { root, shown, motion, options, listeners: [] });
    this.story = storyOf(motion, shown.visits ?? [], shown.name);
    this.startPose = joints(motion, 0);
    this.pose = joints(motion, 0);
    this.focus = focusPath(motion, this.story);
    this.modes = colourModes(motion, this.startPose, shown.colours ?? {});
    this.home = { ...HOME_VIEW, yaw: homeYaw(this.shapePose()) };
    this.state = {
      time: 0, playing: false, direction: 1, speed: startSpeed(motion.nMoves), picked: -1,
      style: "blocks", mode: this.modes[0], whole: false, ...this.home,
    };
    this.quality = 0;
    this.lateFrames = 0;
    this.reduced = matchMedia("(prefers-reduced-motion: reduce)").matches;
    root.classList.add("lineup-player");
    root.setAttribute("role", "group");
    root.setAttribute("aria-label", `Motion of ${shown.name}`);
    root.dataset.lmSuppressShortcuts = "true"; // JupyterLab then leaves the keys to us
    this.ui = controls(root);
    this.scene = options.flat ? null : webglScene(this.ui.view, motion.nJoints);
    if (!this.scene) this.goFlat();
    this.fill();
    listen(this);
    listenToView(this);
    this.resize();
    this.show(this.linkedTime());
  }

  /** Tell of changes: `listener(name, value)` with name time, playing or picked. */
  on(listener) {
    this.listeners.push(listener);
  }

  tell(name, value) {
    for (const listener of this.listeners) listener(name, value);
  }

  // --- Time ---

  show(time) {
    const { state, motion, ui } = this;
    state.time = Math.max(0, Math.min(motion.nMoves, time));
    joints(motion, state.time, this.pose);
    const [where, what] = told(motion, this.story, state.time);
    ui.where.textContent = where;
    ui.what.textContent = what;
    ui.time.value = state.time;
    ui.time.setAttribute("aria-valuetext", where);
    this.refreshDetails();
    this.changed();
    this.tell("time", state.time);
  }

  play() {
    const { state, motion } = this;
    const [from, to] = state.direction > 0 ? [0, motion.nMoves] : [motion.nMoves, 0];
    if (state.time === to) this.show(from);
    this.setPlaying(motion.nMoves > 0);
  }

  pause() {
    this.setPlaying(false);
  }

  setPlaying(playing) {
    if (playing === this.state.playing) return;
    this.state.playing = playing;
    this.lastTick = null;
    this.runningTime = this.state.time;
    this.ui.play.innerHTML = icon(playing ? "pause" : "play") + (playing ? "Pause" : "Play");
    this.changed();
    this.tell("playing", playing);
  }

  setDirection(direction) {
    this.state.direction = direction;
    this.ui.forwards.setAttribute("aria-pressed", String(direction > 0));
    this.ui.backwards.setAttribute("aria-pressed", String(direction < 0));
  }

  stepMove(by) {
    this.pause();
    const { time } = this.state;
    this.show(by > 0 ? Math.floor(time + 1e-9) + 1 : Math.ceil(time - 1e-9) - 1);
  }

  stepLayer(by) {
    this.pause();
    const stops = [0, ...this.story.ticks, this.motion.nMoves];
    const { time } = this.state;
    const next = by > 0
      ? stops.find((stop) => stop > time + 1e-6)
      : stops.findLast((stop) => stop < time - 1e-6);
    this.show(next ?? time);
  }

  linkedTime() {
    const linked = this.options.page && /^#t=([\d.]+)$/.exec(location.hash);
    return linked ? Number(linked[1]) : this.options.time ?? 0;
  }

  // --- What is seen ---

  pick(bar) {
    const { state, ui, motion } = this;
    state.picked = bar >= 0 && bar < motion.nJoints - 1 ? bar : -1;
    ui.block.value = state.picked < 0 ? "" : (state.picked >> 1) + 1;
    ui.card.hidden = state.picked < 0;
    this.refreshDetails();
    this.changed();
    this.tell("picked", state.picked);
  }

  setMode(key) {
    this.state.mode = this.modes.find((mode) => mode.key === key) ?? this.modes[0];
    this.ui.colour.value = this.state.mode.key;
    fillLegend(this.ui.legend, this.state.mode);
    this.resize();
  }

  setStyle(style) {
    this.state.style = style;
    this.changed();
  }

  setWhole(whole) {
    Object.assign(this.state, { whole, zoom: 1, shift: [0, 0] });
    this.ui.inset.setAttribute("aria-pressed", String(whole));
    this.changed();
  }

  resetView() {
    Object.assign(this.state, this.home);
    this.setWhole(false);
  }

  turn(yaw, pitch) {
    this.state.yaw += yaw;
    this.state.pitch = Math.max(-1.5, Math.min(1.5, this.state.pitch + pitch));
    this.changed();
  }

  zoomBy(factor) {
    this.state.zoom = Math.max(0.02, Math.min(60, this.state.zoom * factor));
    this.changed();
  }

  shiftBy(dx, dy) {
    const [x, y] = this.state.shift;
    this.state.shift = [x + dx, y + dy];
    this.changed();
  }

  /** What a scene draws now. */
  frame() {
    const { state, pose, ui, focus } = this;
    const share = this.share();
    const box = state.whole ? boxOf(pose) : focusAt(focus, share, pose);
    const placed = (vector) => upright(focus, share, vector, true);
    const camera = cameraOf(state, box, ui.view.width / ui.view.height, placed);
    return { pose, camera, colours: state.mode, style: state.style, picked: state.picked };
  }

  /** The pose to be seen well at first: that of the shape, even if it is yet to be folded. */
  shapePose() {
    const { motion, story, startPose } = this;
    return story.backwards ? motion.goal ?? joints(motion, motion.nMoves) : startPose;
  }

  share() {
    return this.state.time / this.motion.nMoves || 0;
  }

  draw(fine = false) {
    this.size(this.ui.view, fine ? Math.max(2, devicePixelRatio) : this.ratio());
    const frame = this.frame();
    this.scene.draw(frame);
    const ratio = this.size(this.ui.insetCanvas, Math.min(2, Math.max(1.5, devicePixelRatio)));
    drawInset(this.ui.insetCanvas, frame, ratio);
    this.ui.insetText.textContent = reachText(this.pose);
    this.placeRing(frame);
    this.frames = (this.frames ?? 0) + 1;
    return frame;
  }

  ratio() {
    return Math.min(2, devicePixelRatio || 1) * QUALITIES[this.quality];
  }

  /** Give a canvas so many pixels for each of the page's. */
  size(canvas, ratio) {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight]
      .map((side) => Math.max(2, Math.round(side * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    return ratio;
  }

  /** A ring about the picked block, which may be hidden behind others. */
  placeRing({ camera, pose, picked }) {
    const { ring, view } = this.ui;
    ring.hidden = picked < 0;
    if (ring.hidden) return;
    const middle = [0, 1, 2].map((c) => (pose[3 * picked + c] + pose[3 * picked + 3 + c]) / 2);
    const { across, down, depth } = spotOf(camera, middle);
    ring.hidden = depth <= 0 || across < 0 || across > 1 || down < 0 || down > 1;
    const size = `${Math.max(26, (1.3 * camera.focal * view.clientHeight) / depth)}px`;
    const [left, top] = [`${100 * across}%`, `${100 * down}%`];
    Object.assign(ring.style, { left, top, width: size, height: size });
  }

  pickAt(clientX, clientY) {
    const { view } = this.ui;
    const box = view.getBoundingClientRect();
    const [across, down] = [(clientX - box.left) / box.width, (clientY - box.top) / box.height];
    this.pick(this.scene.pick(this.frame(), across * view.width, down * view.height));
    return this.state.picked;
  }

  // --- What is said ---

  fill() {
    const { ui, shown, story, motion } = this;
    ui.name.textContent = shown.name;
    const [text, kind] = badgeOf(shown.certificate);
    ui.badge.textContent = text;
    ui.badge.classList.add(kind);
    ui.time.max = motion.nMoves;
    ui.block.max = motion.nJoints >> 1;
    const ways = story.hasGoal ? ["Forwards", "Backwards"] : ["Unfold", "Fold"];
    if (story.backwards) ways.reverse();
    [ui.forwards.textContent, ui.backwards.textContent] = ways;
    this.setDirection(1);
    ui.play.innerHTML = `${icon("play")}Play`;
    const fastest = Math.max(8, motion.nMoves / 4);
    ui.speed.min = -2;
    ui.speed.max = Math.log2(fastest);
    this.setSpeed(this.state.speed);
    for (const layer of ui.layers) layer.disabled = !story.ticks.length;
    for (const mode of this.modes) {
      ui.colour.append(Object.assign(element("option", mode.label), { value: mode.key }));
    }
    this.setMode(this.modes[0].key);
    this.fillVerdict();
    describe(ui.file, fileRows(motion, story, shown));
    ui.link.hidden = !this.options.page;
  }

  fillVerdict() {
    const { lines, places } = verdictOf(this.shown.certificate);
    const buttons = places.map(({ label, move, bar }) => {
      const made = element("button", label);
      made.type = "button";
      made.addEventListener("click", () => {
        this.pause();
        this.show(move < 0 ? 0 : move + 0.5);
        this.pick(bar);
      });
      return made;
    });
    this.ui.verdictText.replaceChildren(...lines.map((line) => element("p", line)), ...buttons);
  }

  refreshDetails() {
    const { ui, motion, state, pose } = this;
    if (state.picked >= 0) {
      const seen = (vector) => upright(this.focus, this.share(), vector);
      const [name, text] = aboutBar(this, state.picked, seen);
      ui.picked.textContent = name;
      ui.about.textContent = text;
    }
    if (!ui.drawer.hidden) describe(ui.moment, momentRows(motion, this.story, state.time, pose));
  }

  setSpeed(speed) {
    this.state.speed = speed;
    this.ui.speed.value = Math.log2(speed);
    const shown = speed < 10 ? String(Number(speed.toFixed(1))) : count(speed);
    this.ui.speedText.textContent = `${shown} ${shown === "1" ? "move" : "moves"} a second`;
  }

  openDetails(open) {
    this.ui.drawer.hidden = !open;
    this.ui.more.setAttribute("aria-expanded", String(open));
    this.refreshDetails();
    this.resize();
  }

  link() {
    location.hash = `t=${Number(this.state.time.toFixed(2))}`;
    this.ui.linked.textContent = "The address of this page now leads to this moment.";
  }

  /** The large picture as a PNG, in a blob. */
  picture() {
    this.draw(true);
    return new Promise((done) => this.ui.view.toBlob(done, "image/png"));
  }

  async savePicture() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(await this.picture());
    link.download = `${this.shown.name}-${Math.round(this.state.time)}.png`;
    link.click();
    URL.revokeObjectURL(link.href);
  }

  // --- From frame to frame ---

  changed() {
    this.dirty = true;
    this.fineAt = null;
    this.wait();
  }

  wait() {
    if (!this.waiting && !this.gone) this.waiting = requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    this.waiting = null;
    if (this.gone || this.unseen) return;
    if (this.state.playing) this.advance(now);
    if (this.dirty) {
      this.dirty = false;
      this.draw();
      this.fineAt = now + STILL_MS;
    } else if (this.fineAt !== null && now >= this.fineAt) {
      this.fineAt = null;
      if (this.quality === 0) this.draw(true);
    }
    if (this.state.playing || this.fineAt !== null) this.wait();
  }

  /** Move on in time since the last frame; where less motion is asked for, by steps of a second. */
  advance(now) {
    const { state, motion } = this;
    const passed = this.lastTick === null ? 0 : now - this.lastTick;
    this.lastTick = now;
    this.watch(passed);
    this.runningTime += (state.direction * state.speed * Math.min(passed, 250)) / 1000;
    const step = this.reduced ? state.speed : 0;
    const time = step ? Math.trunc(this.runningTime / step) * step : this.runningTime;
    if (time !== state.time) this.show(time);
    const ended = state.direction > 0 ? this.runningTime >= motion.nMoves : this.runningTime <= 0;
    if (!ended) return;
    this.show(state.direction > 0 ? motion.nMoves : 0);
    this.pause();
  }

  /** Draw fewer pixels after a run of slow frames, and without WebGL after that. */
  watch(passed) {
    if (passed === 0 || passed > 1000) return;
    this.lateFrames = passed > SLOW_MS ? this.lateFrames + 1 : 0;
    if (this.lateFrames < 10) return;
    this.lateFrames = 0;
    if (this.quality + 1 < QUALITIES.length) this.quality++;
    else if (this.scene.kind === "webgl") this.goFlat();
  }

  goFlat() {
    const flat = this.ui.view.cloneNode();
    this.ui.view.replaceWith(flat);
    this.scene?.destroy();
    this.ui.view = flat;
    this.scene = flatScene(flat);
    if (this.unheardView) listenToView(this);
  }

  resize() {
    this.size(this.ui.strip, Math.min(2, devicePixelRatio || 1));
    drawStrip(this.ui.strip, this.motion, this.story, this.state.mode);
    this.changed();
  }

  destroy() {
    this.gone = true;
    cancelAnimationFrame(this.waiting);
    this.unheard();
    this.unheardView();
    this.scene.destroy();
    this.root.replaceChildren();
  }
}

function startSpeed(nMoves) {
  return nMoves / Math.max(4, Math.min(FILM_SECONDS, MOVE_SECONDS * nMoves)) || 1;
}

/** So that the wider of the sides x and y is seen. */
function homeYaw(pose) {
  const { from, to } = boxOf(pose);
  return (to[0] - from[0] >= to[1] - from[1] ? -Math.PI / 3 : -Math.PI / 6);
}
