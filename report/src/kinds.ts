// The types of intersection paths: a colour, a dash and a marker for each, so that nobody needs the colours alone.

export type Dash = "solid" | "long" | "short" | "dots";
export type Marker =
  "circle" | "ring" | "square" | "frame" | "diamond" | "up" | "down" | "plus" | "cross" | "star" | "hexagon";

export interface Kind {
  name: string;
  colour: string;
  dash: Dash;
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
  { name: "EIGHT", colour: "#7b3294", dash: "long", marker: "ring", words: "two loops that share a vertex" },
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

const BY_NAME = new Map(KINDS.map((kind) => [kind.name, kind]));

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

/** The sample of a type: its line with its marker. Drawn once for each type, since lists have hundreds of them. */
export function sample(kind: Kind): HTMLImageElement {
  const image = document.createElement("img");
  image.className = "sample";
  image.alt = "";
  let source = SAMPLES.get(kind.name);
  if (source === undefined) SAMPLES.set(kind.name, (source = drawSample(kind)));
  image.src = source;
  return image;
}

function drawSample(kind: Kind): string {
  const canvas = document.createElement("canvas");
  const scale = 2;
  canvas.width = 56 * scale;
  canvas.height = 20 * scale;
  const g = canvas.getContext("2d")!;
  g.scale(scale, scale);
  g.strokeStyle = kind.colour;
  g.lineWidth = 3;
  g.setLineDash(DASHES[kind.dash] ?? []);
  g.beginPath();
  g.moveTo(3, 10);
  g.lineTo(53, 10);
  g.stroke();
  g.setLineDash([]);
  drawMarker(g, kind.marker, kind.colour, 28, 10, 7);
  return canvas.toDataURL("image/png");
}
