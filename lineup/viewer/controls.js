/** What the player is made of on the page: buttons, sliders, and the drawer with the details. */

const ICONS = {
  start: "M3 2.5h2v11H3zM13.5 2.5v11L6 8z",
  layerBack: "M7.5 3v10L1 8zM14.5 3v10L8 8z",
  moveBack: "M11.5 3v10L4.5 8z",
  play: "M3.5 2v12l10-6z",
  pause: "M3.5 2.5h3.5v11H3.5zM9 2.5h3.5v11H9z",
  moveOn: "M4.5 3v10l7-5z",
  layerOn: "M1.5 3v10L8 8zM8.5 3v10L15 8z",
  end: "M11 2.5h2v11h-2zM2.5 2.5v11L10 8z",
};

const HELP = [
  ["Space", "play, pause"],
  ["← →", "a move back, on"],
  ["Page Up, Page Down", "a layer back, on"],
  ["Home, End", "first, last pose"],
  ["Shift with arrows", "turn the view"],
  ["+ − 0", "nearer, farther, as it was"],
  ["W", "whole chain"],
  ["Esc", "let go of a block, close details"],
];

/** An icon of the player as SVG. */
export function icon(name) {
  return `<svg viewBox="0 0 16 16" aria-hidden="true"><path d="${ICONS[name]}"/></svg>`;
}

function button(does, label, key, inside = icon(does)) {
  const title = key ? `${label} (${key})` : label;
  return `<button type="button" data-do="${does}" title="${title}" aria-label="${label}">${inside}</button>`;
}

function keys() {
  return HELP.map(([key, does]) => `<dt>${key}</dt><dd>${does}</dd>`).join("");
}

const VIEW_LABEL =
  "The chain in 3D. Drag to turn it, use the wheel to come nearer, hold shift and drag to move " +
  "it, click a block to see its number.";

const STRIP_LABEL =
  "What moves when: above, of the last end of the chain, and below, of the first. " +
  "Dark ticks: another layer.";

const MARKUP = `<div class="frame">
<div class="stage">
  <canvas class="view" tabindex="0" role="img" aria-label="${VIEW_LABEL}"></canvas>
  <div class="ring" hidden></div>
  <div class="head"><span class="name"></span><button type="button" class="badge" data-do="verdict"></button></div>
  <div class="card" role="status" hidden>
    <button type="button" data-do="unpick" aria-label="Let go of this block" title="Let go (Esc)">×</button>
    <strong class="picked"></strong><span class="about"></span>
  </div>
  <button type="button" class="inset" data-do="whole" aria-pressed="false"
    aria-label="Show the whole chain in the large picture" title="Show the whole chain (W)">
    <canvas></canvas><span></span></button>
</div>
<div class="panel">
  <div class="words"><div><p class="where"></p><p class="what"></p></div>
    <button type="button" class="more" data-do="details" aria-expanded="false">Details</button></div>
  <canvas class="strip" aria-hidden="true" title="${STRIP_LABEL}"></canvas>
  <input class="time" type="range" min="0" step="any" aria-label="Moment of the motion">
  <div class="row">
    <div class="buttons">
      ${button("start", "To the first pose", "Home")}
      ${button("layerBack", "A layer back", "Page Up")}
      ${button("moveBack", "A move back", "←")}
      <button type="button" class="play" data-do="play" title="Space"></button>
      ${button("moveOn", "A move on", "→")}
      ${button("layerOn", "A layer on", "Page Down")}
      ${button("end", "To the last pose", "End")}
    </div>
    <div class="ways" role="group" aria-label="Direction">
      <button type="button" data-do="forwards"></button><button type="button" data-do="backwards"></button>
    </div>
    <label class="speed">Speed <input class="speed" type="range" step="0.1"><output></output></label>
    <label title="Blocks count from 1 at the first end, which a manual calls the head">Block
      <input class="block" type="number" min="1" placeholder="number"></label>
  </div>
</div>
<aside class="drawer" aria-label="Details" hidden>
  <section><h3>Look</h3>
    <label>Colour <select class="colour"></select></label>
    <div class="legend"><span></span><canvas width="64" height="1"></canvas><span></span></div>
    <label>Show <select class="style">
      <option value="blocks">blocks and joints</option>
      <option value="printed">parts as printed</option>
      <option value="bars">bars as wide as a voxel</option>
      <option value="lines">thin lines</option></select></label>
    <p>${button("reset", "View as it was", "0", "Reset the view")}
      ${button("picture", "Save this picture", "", "Save picture (PNG)")}
      ${button("link", "Link to this moment", "", "Link to this moment")}</p>
    <output class="linked"></output>
  </section>
  <section class="verdict" tabindex="-1"><h3>Judge</h3><div></div></section>
  <section><h3>This moment</h3><dl class="moment"></dl></section>
  <section><h3>This motion</h3><dl class="file"></dl></section>
  <section><h3>Keys</h3><dl>${keys()}</dl></section>
</aside></div>`;

/** Fill an element with the player's markup and return its parts by name. */
export function controls(root) {
  root.innerHTML = MARKUP;
  const one = (selector) => root.querySelector(selector);
  return {
    stage: one(".stage"), view: one("canvas.view"), ring: one(".ring"),
    name: one(".name"), badge: one(".badge"),
    card: one(".card"), picked: one(".picked"), about: one(".about"),
    inset: one(".inset"), insetCanvas: one(".inset canvas"), insetText: one(".inset span"),
    where: one(".where"), what: one(".what"), strip: one(".strip"), time: one(".time"),
    play: one(".play"), forwards: one("[data-do=forwards]"), backwards: one("[data-do=backwards]"),
    speed: one("input.speed"), speedText: one("label.speed output"), block: one(".block"),
    more: one(".more"), drawer: one(".drawer"), colour: one(".colour"), style: one(".style"),
    legend: one(".legend"), link: one("[data-do=link]"), linked: one(".linked"),
    verdict: one(".verdict"), verdictText: one(".verdict div"),
    moment: one(".moment"), file: one(".file"),
    layers: [one("[data-do=layerBack]"), one("[data-do=layerOn]")],
  };
}

/** Fill a description list with rows of [term, text]. */
export function describe(list, rows) {
  list.replaceChildren(
    ...rows.flatMap(([term, text]) => [element("dt", term), element("dd", text)]),
  );
}

/** Show the colours of a mode and what they mean. */
export function fillLegend(legend, { low, high, shades }) {
  const [from, canvas, to] = legend.children;
  from.textContent = low;
  to.textContent = high;
  const context = canvas.getContext("2d");
  shades.forEach((shade, x) => {
    context.fillStyle = `rgb(${shade})`;
    context.fillRect(x, 0, 1, 1);
  });
}

/** An element that holds a text. */
export function element(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}
