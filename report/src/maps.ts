// Colour maps that colour-blind people read, too: from pale to dark blue for amounts, from blue through grey
// to orange for what is shorter and longer. Lines at each fifth stand beside the colours.
import { DataTexture, LinearFilter, RGBAFormat } from "three";

import { digits, metres } from "./dom";

type Stops = [number, number, number][];

const LITTLE_MUCH: Stops = [
  [250, 246, 226],
  [233, 235, 180],
  [178, 218, 184],
  [112, 192, 190],
  [58, 150, 186],
  [38, 103, 166],
  [36, 58, 130],
  [16, 24, 78],
];
const SHORT_LONG: Stops = [
  [5, 60, 130],
  [60, 115, 180],
  [130, 170, 210],
  [195, 212, 226],
  [232, 232, 228],
  [240, 208, 170],
  [228, 160, 95],
  [200, 105, 30],
  [140, 60, 0],
];

function at(stops: Stops, t: number): [number, number, number] {
  const place = Math.max(0, Math.min(1, t)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(place));
  const f = place - i;
  const [a, b] = [stops[i]!, stops[i + 1]!];
  return [0, 1, 2].map((k) => Math.round(a[k]! + (b[k]! - a[k]!) * f)) as [number, number, number];
}

export interface ColourMap {
  name: "moved" | "stretch";
  title: string;
  /** For each vertex from 0 to 1. */
  values: Float32Array;
  stops: Stops;
  /** What stands at 0, 1/4 and so on. */
  ticks: string[];
  /** The value of a vertex in words. */
  words: (vertex: number) => string;
}

export function movedMap(moved: Float32Array): ColourMap {
  const most = moved.reduce((a, b) => Math.max(a, b), 0);
  return {
    name: "moved",
    title: "Distance moved, on a scale of square roots so that small distances show",
    values: moved.map((value) => (most > 0 ? Math.sqrt(value / most) : 0)),
    stops: LITTLE_MUCH,
    ticks: [0, 0.25, 0.5, 0.75, 1].map((t) => metres(t * t * most)),
    words: (vertex) => `moved ${metres(moved[vertex]!)}`,
  };
}

/** Ratios on a logarithmic scale, 1 in the middle. */
export function stretchMap(stretch: Float32Array): ColourMap {
  const bad = (ratio: number) => Math.abs(Math.log(Math.max(ratio, 1e-6)));
  const most = Math.min(
    Math.log(4),
    Math.max(
      Math.log(1.02),
      stretch.reduce((a, b) => Math.max(a, bad(b)), 0),
    ),
  );
  return {
    name: "stretch",
    title: "Stretch: length after divided by length before, of the worst edge of each vertex",
    values: stretch.map((ratio) => 0.5 + (0.5 * Math.log(Math.max(ratio, 1e-6))) / most),
    stops: SHORT_LONG,
    ticks: [-1, -0.5, 0, 0.5, 1].map((t) => `${digits(Number(Math.exp(t * most).toPrecision(3)))} ×`),
    words: (vertex) => `its worst edge is ${digits(stretch[vertex]!)} times as long as before`,
  };
}

export function textureOf(map: ColourMap | null): DataTexture {
  const data = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; i++) data.set([...at(map?.stops ?? LITTLE_MUCH, i / 255), 255], 4 * i);
  const texture = new DataTexture(data, 256, 1, RGBAFormat);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export function gradientOf(map: ColourMap): string {
  const colours = map.stops.map((stop) => `rgb(${stop.join(" ")})`);
  return `linear-gradient(to right, ${colours.join(", ")})`;
}
