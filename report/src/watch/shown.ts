// A frame as the picture takes it.
import type { Line, Shown } from "../data";
import { FLAGS, type FrameMessage } from "./message";

/** Points of a line that are nearer than `apart` metres to the one before are left out. */
export function shownOf(frame: FrameMessage, apart: number): Shown {
  const { positions, paths, inside } = frame;
  const points = apart > 0 ? new Float32Array(frame.points.length) : frame.points;
  const lines: Line[] = [];
  let end = 0;
  for (let i = 0; i + 2 < frame.lines.length; i += 3) {
    const line = { path: frame.lines[i]!, first: frame.lines[i + 1]!, count: frame.lines[i + 2]! };
    lines.push(apart > 0 ? thinned(frame.points, line, apart, points, end) : line);
    end += lines.at(-1)!.count;
  }
  return { positions, paths, points, lines, inside, marked: marked(frame.flags) };
}

/** Writes the points of a line that count into `kept`, from point `start` on; its ends stay. */
function thinned(points: Float32Array, line: Line, apart: number, kept: Float32Array, start: number): Line {
  const last = line.first + line.count - 1;
  let count = 0;
  for (let point = line.first, before = -1; point <= last; point++) {
    if (before >= 0 && point < last) {
      let square = 0;
      for (let axis = 0; axis < 3; axis++) square += (points[3 * point + axis]! - points[3 * before + axis]!) ** 2;
      if (square < apart * apart) continue;
    }
    before = point;
    for (let axis = 0; axis < 3; axis++) kept[3 * (start + count) + axis] = points[3 * point + axis]!;
    count += 1;
  }
  return { path: line.path, first: start, count };
}

/** The vertices of each flag that occurs. */
function marked(flags: Uint8Array): Shown["marked"] {
  const names = Object.keys(FLAGS) as (keyof typeof FLAGS)[];
  const vertices: Record<keyof typeof FLAGS, number[]> = { masked: [], clamped: [], pinned: [], body: [], layer: [] };
  for (let vertex = 0; vertex < flags.length; vertex++) {
    const own = flags[vertex]!;
    if (own === 0) continue;
    for (const name of names) if ((own & FLAGS[name]) !== 0) vertices[name].push(vertex);
  }
  return names.map((name) => ({ name, vertices: vertices[name] })).filter(({ vertices }) => vertices.length > 0);
}
