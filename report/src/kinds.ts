// The types of intersection paths: a colour, a dash and a marker for each, so that nobody needs the colours alone.

export type Dash = "solid" | "long" | "short" | "dots";
export type Marker =
  "circle" | "ring" | "square" | "frame" | "diamond" | "up" | "down" | "plus" | "cross" | "star" | "hexagon";

/** How a line is drawn. */
export interface Stroke {
  colour: string;
  dash: Dash;
}

export interface Kind extends Stroke {
  name: string;
  marker: Marker;
  words: string;
}

/** Lengths of dashes and gaps in pixels. */
export const DASHES: Record<Dash, [number, number] | null> = {
  solid: null,
  long: [16, 6],
  short: [8, 5],
  dots: [3, 4],
};

export const KINDS: Kind[] = [
  { name: "CLOSED/CLOSED", colour: "#0068a8", dash: "solid", marker: "circle", words: "a loop on both sheets" },
  { name: "EIGHT", colour: "#9440b8", dash: "long", marker: "ring", words: "two loops that share a vertex" },
  { name: "LL", colour: "#c8460a", dash: "solid", marker: "diamond", words: "a fold pushed through itself" },
  {
    name: "BLI",
    colour: "#c2187a",
    dash: "short",
    marker: "up",
    words: "from the boundary round a loop vertex to the inside",
  },
  {
    name: "BLB",
    colour: "#6b4a00",
    dash: "long",
    marker: "down",
    words: "from the boundary round a loop vertex to the boundary",
  },
  { name: "BLLB", colour: "#5e6b00", dash: "dots", marker: "hexagon", words: "two BLI that touch in the boundary" },
  { name: "CROSS", colour: "#007a7a", dash: "dots", marker: "plus", words: "two BLI of one loop vertex" },
  {
    name: "BB/II",
    colour: "#1a1a1a",
    dash: "solid",
    marker: "square",
    words: "one sheet dips through the other with its end",
  },
  { name: "BB/BI", colour: "#3b2fa0", dash: "short", marker: "frame", words: "an end dips through at a boundary" },
  {
    name: "BB/BB",
    colour: "#002a8c",
    dash: "dots",
    marker: "star",
    words: "both sheets are cut from boundary to boundary",
  },
  {
    name: "BI/BI",
    colour: "#b86e00",
    dash: "long",
    marker: "cross",
    words: "two sheets cut into each other from their edges",
  },
];

/** Vertices that are marked: a colour and a marker for each kind, its size in pixels, and words. */
export interface DotKind {
  colour: string;
  marker: Marker;
  size: number;
  words: string;
}

export const DOTS = {
  body: { colour: "#a000a0", marker: "circle", size: 9, words: "vertices inside of a body" },
  layer: { colour: "#006400", marker: "square", size: 9, words: "vertices behind an inner layer" },
  pinned: { colour: "#000000", marker: "diamond", size: 9, words: "pinned vertices" },
  masked: { colour: "#00566e", marker: "down", size: 6, words: "masked vertices: self-contact is off there" },
  clamped: { colour: "#b01030", marker: "star", size: 11, words: "corrections that were limited" },
} satisfies Record<string, DotKind>;

export type DotName = keyof typeof DOTS;

const BY_NAME = new Map(KINDS.map((kind) => [kind.name, kind]));

/** Counted from 1. */
export function numberOf(name: string): number {
  return 1 + KINDS.indexOf(kindOf(name));
}

export function kindOf(name: string): Kind {
  return BY_NAME.get(name) ?? KINDS[0]!;
}

/** Draws a marker round a place, with a light rim so that it stands out from any cloth. */
export function drawMarker(
  g: CanvasRenderingContext2D,
  marker: Marker,
  colour: string,
  x: number,
  y: number,
  r: number,
) {
  const path = new Path2D();
  const polygon = (count: number, turn: number, inner = 1) => {
    for (let i = 0; i < count; i++) {
      const angle = turn + (2 * Math.PI * i) / count;
      const at = inner !== 1 && i % 2 === 1 ? r * inner : r;
      const [px, py] = [x + at * Math.sin(angle), y - at * Math.cos(angle)];
      if (i === 0) path.moveTo(px, py);
      else path.lineTo(px, py);
    }
    path.closePath();
  };
  const bar = (angle: number) => {
    const [dx, dy] = [r * Math.cos(angle), r * Math.sin(angle)];
    path.moveTo(x - dx, y - dy);
    path.lineTo(x + dx, y + dy);
  };
  switch (marker) {
    case "circle":
    case "ring":
      path.arc(x, y, r * 0.85, 0, 2 * Math.PI);
      break;
    case "square":
    case "frame":
      path.rect(x - r * 0.75, y - r * 0.75, r * 1.5, r * 1.5);
      break;
    case "diamond":
      polygon(4, 0);
      break;
    case "up":
      polygon(3, 0);
      break;
    case "down":
      polygon(3, Math.PI);
      break;
    case "star":
      polygon(10, 0, 0.45);
      break;
    case "hexagon":
      polygon(6, Math.PI / 6);
      break;
    case "plus":
      bar(0);
      bar(Math.PI / 2);
      break;
    case "cross":
      bar(Math.PI / 4);
      bar(-Math.PI / 4);
      break;
  }
  const isLine = ["ring", "frame", "plus", "cross"].includes(marker);
  g.lineJoin = "round";
  g.lineCap = "round";
  g.strokeStyle = "#ffffff";
  g.lineWidth = isLine ? r * 0.95 : r * 0.35;
  g.stroke(path);
  if (isLine) {
    g.strokeStyle = colour;
    g.lineWidth = r * 0.5;
    g.stroke(path);
  } else {
    g.fillStyle = colour;
    g.fill(path);
  }
}

const SAMPLES = new Map<string, string>();

/** The sample of a type: its line with its marker. */
export function sample(kind: Kind): HTMLImageElement {
  return sampleOf(kind.name, (g) => {
    drawLine(g, kind);
    drawMarker(g, kind.marker, kind.colour, 28, 10, 7);
  });
}

/** The sample of a kind of marked vertices. */
export function dotSample(name: DotName): HTMLImageElement {
  const { colour, marker, size } = DOTS[name];
  return sampleOf(name, (g) => drawMarker(g, marker, colour, 28, 10, (0.7 * size) / 1.3 + 1));
}

/** The sample of a line of a plot. */
export function lineSample(name: string, line: Stroke): HTMLImageElement {
  return sampleOf(`line ${name}`, (g) => drawLine(g, line));
}

/** Drawn once for each name, since lists have hundreds of them. */
function sampleOf(name: string, draw: (g: CanvasRenderingContext2D) => void): HTMLImageElement {
  const image = document.createElement("img");
  image.className = "sample";
  image.alt = "";
  let source = SAMPLES.get(name);
  if (source === undefined) SAMPLES.set(name, (source = drawn(draw)));
  image.src = source;
  return image;
}

function drawn(draw: (g: CanvasRenderingContext2D) => void): string {
  const canvas = document.createElement("canvas");
  const scale = 2;
  canvas.width = 56 * scale;
  canvas.height = 20 * scale;
  // To be read back at once: elsewhere than in memory the first one takes a third of a second.
  const g = canvas.getContext("2d", { willReadFrequently: true })!;
  g.scale(scale, scale);
  draw(g);
  return canvas.toDataURL("image/png");
}

function drawLine(g: CanvasRenderingContext2D, kind: Stroke) {
  g.strokeStyle = kind.colour;
  g.lineWidth = 3;
  g.setLineDash(DASHES[kind.dash] ?? []);
  g.beginPath();
  g.moveTo(3, 10);
  g.lineTo(53, 10);
  g.stroke();
  g.setLineDash([]);
}
