/** How the player listens: buttons, keys, fingers, the wheel, and changes of size. */

const TURN = 0.008; // radians for each pixel dragged
const KEY_TURN = 0.12;

const ACTS = {
  start: (player) => (player.pause(), player.show(0)),
  end: (player) => (player.pause(), player.show(player.motion.nMoves)),
  layerBack: (player) => player.stepLayer(-1),
  layerOn: (player) => player.stepLayer(1),
  moveBack: (player) => player.stepMove(-1),
  moveOn: (player) => player.stepMove(1),
  play: (player) => (player.state.playing ? player.pause() : player.play()),
  forwards: (player) => player.setDirection(1),
  backwards: (player) => player.setDirection(-1),
  whole: (player) => player.setWhole(!player.state.whole),
  unpick: (player) => player.pick(-1),
  details: (player) => player.openDetails(player.ui.drawer.hidden),
  verdict: (player) => {
    player.openDetails(true);
    player.ui.verdict.scrollIntoView({ block: "nearest" });
  },
  reset: (player) => player.resetView(),
  picture: (player) => player.savePicture(),
  link: (player) => player.link(),
  nearer: (player) => player.zoomBy(1.2),
  farther: (player) => player.zoomBy(1 / 1.2),
  turnLeft: (player) => player.turn(-KEY_TURN, 0),
  turnRight: (player) => player.turn(KEY_TURN, 0),
  turnUp: (player) => player.turn(0, KEY_TURN),
  turnDown: (player) => player.turn(0, -KEY_TURN),
  escape: (player) => (player.state.picked < 0 ? player.openDetails(false) : player.pick(-1)),
};

const KEYS = {
  " ": "play", ArrowLeft: "moveBack", ArrowRight: "moveOn", PageUp: "layerBack",
  PageDown: "layerOn", Home: "start", End: "end", Escape: "escape",
  "+": "nearer", "=": "nearer", "-": "farther", "0": "reset", w: "whole", W: "whole",
};
const SHIFTED = {
  ArrowLeft: "turnLeft", ArrowRight: "turnRight", ArrowUp: "turnUp", ArrowDown: "turnDown",
};

/** Wire everything but the large picture; `player.unheard()` lets go of it. */
export function listen(player) {
  const { root, ui, options } = player;
  const leave = new AbortController();
  const { signal } = leave;
  root.addEventListener("click", (event) => {
    const does = event.target.closest("[data-do]")?.dataset.do;
    if (does) ACTS[does](player);
  }, { signal });
  // A page of its own has no other use for the keys, wherever the focus is.
  const ears = options.page ? document : root;
  ears.addEventListener("keydown", (event) => heard(player, event), { signal });
  const input = (part, does) => part.addEventListener("input", does, { signal });
  input(ui.time, () => (player.pause(), player.show(Number(ui.time.value))));
  input(ui.speed, () => player.setSpeed(2 ** Number(ui.speed.value)));
  input(ui.block, () => player.pick(ui.block.value ? 2 * Number(ui.block.value) - 2 : -1));
  input(ui.colour, () => player.setMode(ui.colour.value));
  input(ui.style, () => player.setStyle(ui.style.value));
  const sizes = new ResizeObserver(() => player.resize());
  sizes.observe(ui.stage);
  const sight = new IntersectionObserver((entries) => {
    player.unseen = !entries.at(-1).isIntersecting;
    player.lastTick = null;
    player.changed();
  });
  sight.observe(root);
  player.unheard = () => {
    leave.abort();
    sizes.disconnect();
    sight.disconnect();
  };
}

function heard(player, event) {
  const { target } = event;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const typing = target.closest?.("select, input:not([type=range])");
  const own = target === player.ui.speed && event.key.startsWith("Arrow");
  const presses = target.closest?.("button") && event.key === " ";
  const does = (event.shiftKey && SHIFTED[event.key]) || KEYS[event.key];
  if (!does || own || presses || (typing && event.key !== "Escape")) return;
  event.preventDefault();
  event.stopPropagation();
  ACTS[does](player);
}

/** Wire the large picture: drag, pinch, wheel, click; again after it was replaced. */
export function listenToView(player) {
  const { view } = player.ui;
  player.unheardView?.();
  const leave = new AbortController();
  const on = (name, does, options) =>
    view.addEventListener(name, does, { signal: leave.signal, ...options });
  const fingers = new Map();
  let [moved, apart] = [0, 0];
  on("pointerdown", (event) => {
    view.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
    if (fingers.size === 1) moved = 0;
    apart = spread(fingers);
  });
  on("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
    moved += Math.abs(dx) + Math.abs(dy);
    fingers.set(event.pointerId, event);
    if (fingers.size === 2) {
      player.zoomBy(spread(fingers) / apart);
      apart = spread(fingers);
    } else if (event.shiftKey || event.buttons & 6) {
      const scale = 0.83 / view.clientHeight;
      player.shiftBy(-dx * scale, dy * scale);
    } else player.turn(-dx * TURN, dy * TURN);
  });
  on("pointerup", (event) => {
    const clicked = fingers.delete(event.pointerId) && moved < 5 && event.button === 0;
    if (clicked) player.pickAt(event.clientX, event.clientY);
  });
  on("pointercancel", (event) => fingers.delete(event.pointerId));
  on("contextmenu", (event) => event.preventDefault());
  on("wheel", (event) => {
    // In a notebook the wheel scrolls on, unless the picture was clicked first.
    const meant = player.options.page || event.ctrlKey || document.activeElement === view;
    if (!meant) return;
    event.preventDefault();
    player.zoomBy(Math.exp(-event.deltaY * 0.001));
  }, { passive: false });
  on("webglcontextlost", (event) => event.preventDefault());
  on("webglcontextrestored", () => {
    player.scene.rebuild();
    player.changed();
  });
  player.unheardView = () => leave.abort();
}

function spread(fingers) {
  const [a, b] = fingers.values();
  return b ? Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) : 0;
}
