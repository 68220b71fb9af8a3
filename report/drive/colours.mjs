// node drive/colours.mjs: whether colour-blind people tell the types of paths, the marked vertices and the lines of
// plots apart. Each pair of a group either differs in what is no colour (dash and marker of paths, dash of plots,
// marker of vertices), or its colours stay apart for everybody. Prints the nearest pairs; a pair that fails ends it
// with exit code 1.
import { build } from "esbuild";

/** Severity 1 of Machado, Oliveira and Fernandes, A Physiologically-based Model for Simulation of Color Vision
 * Deficiency, IEEE TVCG 15 (6), 2009, table 1; they apply to linear RGB. */
const VISIONS = {
  usual: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};
/** Distance in CIELAB from which colours of lines count as apart: some eight times what is just noticeable. */
const APART = 20;

const { outputFiles } = await build({
  stdin: {
    contents: 'export * from "./src/kinds.ts"; export * from "./src/watch/palette.ts";',
    resolveDir: new URL("..", import.meta.url).pathname,
  },
  bundle: true,
  write: false,
  format: "esm",
});
const { KINDS, DOTS, PLOTS } = await import(
  `data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`
);

function linear(colour) {
  const value = parseInt(colour.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255].map((own) => {
    const part = own / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
}

const times = (m, v) => [0, 1, 2].map((row) => m[3 * row] * v[0] + m[3 * row + 1] * v[1] + m[3 * row + 2] * v[2]);
const XYZ = [0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.072175, 0.0193339, 0.119192, 0.9503041];
const WHITE = [0.95047, 1, 1.08883];

/** CIELAB of a colour as it is seen. */
function lab(colour, vision) {
  const seen = times(VISIONS[vision], linear(colour)).map((part) => Math.max(0, Math.min(1, part)));
  const [x, y, z] = times(XYZ, seen)
    .map((part, axis) => part / WHITE[axis])
    .map((t) => (t > 216 / 24389 ? Math.cbrt(t) : ((24389 / 27) * t + 16) / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

function distance(a, b, vision) {
  const [p, q] = [lab(a, vision), lab(b, vision)];
  return Math.hypot(...p.map((value, axis) => value - q[axis]));
}

const shapes =
  (...names) =>
  (a, b) =>
    names.every((name) => a[name] !== b[name]);
const groups = [
  ["types of paths", KINDS, shapes("dash", "marker")],
  ["marked vertices", Object.entries(DOTS).map(([name, dot]) => ({ name, ...dot })), shapes("marker")],
  ...Object.entries(PLOTS).map(([name, lines]) => [`plot of ${name}`, lines, shapes("dash")]),
];
let failed = 0;
for (const [title, all, differ] of groups) {
  let nearest = [Infinity, ""];
  for (const vision of Object.keys(VISIONS)) {
    all.forEach((a, at) => {
      for (const b of all.slice(at + 1)) {
        const apart = distance(a.colour, b.colour, vision);
        const words = `${a.name} and ${b.name}, ${vision}: ${apart.toFixed(1)}`;
        if (!differ(a, b) && apart < nearest[0]) nearest = [apart, words];
        if (differ(a, b) || apart >= APART) continue;
        failed += 1;
        console.log(`${title}: ${words}, nearer than ${APART}, and the same shape`);
      }
    });
  }
  console.log(`${title}: nearest of one shape: ${nearest[1] || "none has the shape of another"}`);
}
process.exitCode = failed > 0 ? 1 : 0;
