/** Colours of the bars: what each mode says of a bar, from 0 to 1, and the colour of that. */

const N_SHADES = 64;
const UNKNOWN = 255; // the index of a bar of which nothing is known
const GREY = [150, 156, 164];

const VIRIDIS = [
  [68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142],
  [31, 158, 137], [53, 183, 121], [109, 205, 89], [180, 222, 44], [253, 231, 37],
];
const TWO_PARTS = [[46, 134, 193], [240, 160, 60]];

/**
 * Ways to colour a chain: { key, label, low, high, index, shades }.
 *
 * `index` has one shade for each bar, `shades` are (64, 3) numbers 0 to 255; `low` and `high`
 * say what the first and the last shade mean. `extra` maps a name to a number for each bar.
 */
export function colourModes(motion, startPose, extra = {}) {
  const nBars = motion.nJoints - 1;
  const along = Array.from({ length: nBars }, (_, i) => (nBars > 1 ? i / (nBars - 1) : 0));
  const heights = along.map((_, i) => (startPose[3 * i + 2] + startPose[3 * i + 5]) / 2);
  const [turbo, viridis, parts] = [shades(turboAt), shades(viridisAt), shades(partAt)];
  const ends = { low: "first block", high: "last block" };
  return [
    { key: "chain", label: "along the chain", ...ends, ...mode(along, turbo) },
    { key: "safe", label: "along the chain, for all eyes", ...ends, ...mode(along, viridis) },
    { key: "layer", label: "layers", low: "bottom", high: "top", ...mode(scaled(heights), turbo) },
    { key: "part", label: "in and between blocks", low: "in a block", high: "between two",
      ...mode(along.map((_, i) => i % 2), parts) },
    ...Object.entries(extra).map(([name, values]) => ({
      key: `by ${name}`, label: name, ...limitsOf(values), values,
      ...mode(scaled(values), viridis),
    })),
  ];
}

/** The colour of a bar: three numbers from 0 to 255. */
export function shadeOf({ index, shades: table }, bar) {
  return index[bar] === UNKNOWN ? GREY : table[index[bar]];
}

function mode(values, table) {
  const shade = (v) => Math.min(N_SHADES - 1, Math.max(0, Math.floor(v * N_SHADES)));
  const index = Uint8Array.from(values, (v) => (Number.isFinite(v) ? shade(v) : UNKNOWN));
  return { index, shades: table };
}

function shades(colourAt) {
  return Array.from({ length: N_SHADES }, (_, i) => colourAt(i / (N_SHADES - 1)));
}

function limits(values) {
  const known = values.filter((v) => v !== null && Number.isFinite(v));
  return known.length ? [Math.min(...known), Math.max(...known)] : [0, 0];
}

function scaled(values) {
  const [low, high] = limits(values);
  return values.map((v) => (v === null ? NaN : high > low ? (v - low) / (high - low) : 0.5));
}

function limitsOf(values) {
  const [low, high] = limits(values).map((v) => String(Number(v.toPrecision(4))));
  return { low, high };
}

/** The colour map turbo without its ends, which are too dark to be told apart. */
function turboAt(share) {
  const x = 0.08 + 0.84 * share;
  const sum = (...factors) => factors.reduceRight((total, factor) => total * x + factor, 0);
  return [
    sum(0.1357, 4.5974, -42.3277, 130.5887, -150.5666, 58.1375),
    sum(0.0914, 2.1856, 4.8052, -14.0195, 4.2109, 2.7747),
    sum(0.1067, 12.5925, -60.1097, 109.0745, -88.5066, 26.8183),
  ].map((part) => Math.round(255 * Math.max(0, Math.min(1, part))));
}

function viridisAt(share) {
  const at = share * (VIRIDIS.length - 1);
  const [low, high] = [VIRIDIS[Math.floor(at)], VIRIDIS[Math.ceil(at)]];
  return low.map((part, c) => Math.round(part + (high[c] - part) * (at % 1)));
}

function partAt(share) {
  return TWO_PARTS[share < 0.5 ? 0 : 1];
}
