// What the program writes into a page: PageData in src/cli/html/page.rs.

import { type DotName, numberOf } from "./kinds";

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonObject = { [key: string]: Json };

export interface PageData {
  schema: string;
  version: string;
  command: "check" | "fix";
  summary: string;
  settings: { name: string; value: string }[];
  report: JsonObject;
  mesh: {
    parts: Part[];
    num_vertices: number;
    triangles: string;
    centre: [number, number, number];
    pinned: number[];
  };
  states: StateData[];
  change?: { moved_m: string; stretch: string };
  sequence?: SequenceData;
}

/** The frames of a shot. Coordinates are whole numbers of steps from the lowest, of two bytes. */
export interface SequenceData {
  low: [number, number, number];
  step: [number, number, number];
  /** Differences to the frame before, and of `after` to `before`; low bytes first, then high bytes; compressed. */
  before: string;
  after?: string;
  /** For each frame the logarithm of the stretch of each vertex in steps of 0.0005; packed in the same way. */
  stretch?: string;
  frames: { frame: number; line: JsonObject; states: FoundData[] }[];
}

export interface Part {
  file: string;
  role: "cloth" | "layer" | "body";
  num_vertices: number;
  num_faces: number;
}

/** What was found in a state. */
export interface FoundData {
  paths?: PathData[];
  points: string;
  lines: string;
  wrong_sides: WrongData[];
}

export interface StateData extends FoundData {
  name: "check" | "before" | "after";
  positions: string;
}

export interface WrongData {
  kind: "body" | "layer";
  vertices: number[];
  depths_m: number[];
  clusters: { vertex: number; num_vertices: number; depth_m: number }[];
}

export type End =
  { kind: "boundary" | "junction"; edge: [number, number]; face: number } | { kind: "loop"; vertex: number };

export interface PathData {
  pair_type: string;
  closed: boolean;
  num_segments: number;
  length_m: number;
  loop_vertices: number[];
  ends: End[];
  copies: { type: string; num_segments: number; inside_vertices: number[] | null; partitioning: boolean }[];
}

export interface BlockedData {
  pair_type?: string;
  num_vertices_inside_body?: number;
  vertex: number;
  file: string;
  vertex_in_file: number;
  part: string | null;
  length_m: number;
  reason: string;
}

/** A run of points of a path: the path, and its first point and number of points. */
export interface Line {
  path: number;
  first: number;
  count: number;
}

/** What the picture takes of a state. */
export interface Shown {
  positions: Float32Array;
  paths: { pair_type: string; length_m: number }[];
  points: Float32Array;
  lines: Line[];
  marked: { name: DotName; vertices: ArrayLike<number> }[];
  /** For each vertex the number of its type of path, counted from 1, where it is inside of one; else 0. */
  inside: Uint8Array;
}

/** A state with its arrays. */
export interface State extends Shown {
  name: StateData["name"];
  paths: PathData[];
  wrongSides: WrongData[];
}

/** The document of this page, as its text and read. */
export function readPage(): PageData {
  return JSON.parse(document.getElementById("data")?.textContent ?? "{}") as PageData;
}

export function bytes(text: string): Uint8Array {
  const binary = atob(text);
  const result = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) result[i] = binary.charCodeAt(i);
  return result;
}

export function singles(text: string): Float32Array {
  return new Float32Array(bytes(text).buffer);
}

export function whole(text: string): Uint32Array {
  return new Uint32Array(bytes(text).buffer);
}

export function readState(page: PageData, data: StateData): State {
  return stateOf(page, data.name, singles(data.positions), data);
}

export function stateOf(page: PageData, name: StateData["name"], positions: Float32Array, data: FoundData): State {
  const rows = whole(data.lines);
  const lines: Line[] = [];
  for (let i = 0; i + 2 < rows.length; i += 3) {
    lines.push({ path: rows[i]!, first: rows[i + 1]!, count: rows[i + 2]! });
  }
  const paths = data.paths ?? (page.report["paths"] as unknown as PathData[]) ?? [];
  const marked: Shown["marked"] = data.wrong_sides.map(({ kind, vertices }) => ({ name: kind, vertices }));
  if (page.mesh.pinned.length > 0) marked.push({ name: "pinned", vertices: page.mesh.pinned });
  return {
    name,
    positions,
    paths,
    marked,
    inside: insideOf(paths, positions.length / 3),
    points: singles(data.points),
    lines,
    wrongSides: data.wrong_sides,
  };
}

function insideOf(paths: PathData[], numVertices: number): Uint8Array {
  const inside = new Uint8Array(numVertices);
  for (const path of paths) {
    const number = numberOf(path.pair_type);
    for (const copy of path.copies) for (const vertex of copy.inside_vertices ?? []) inside[vertex] = number;
  }
  return inside;
}

/** What is blocked, of a sequence in a frame. */
export function blockedOf(page: PageData, frame: number): BlockedData[] {
  const report = page.sequence?.frames[frame]?.line ?? page.report;
  return (report["blocked"] as unknown as BlockedData[]) ?? [];
}
