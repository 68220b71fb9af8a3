// A frame as the picture takes it.
import type { Line, Shown } from "../data";
import { FLAGS, type FrameMessage } from "./message";

export function shownOf(frame: FrameMessage): Shown {
  const { positions, paths, points, inside } = frame;
  const lines: Line[] = [];
  for (let i = 0; i + 2 < frame.lines.length; i += 3) {
    lines.push({ path: frame.lines[i]!, first: frame.lines[i + 1]!, count: frame.lines[i + 2]! });
  }
  return { positions, paths, points, lines, inside, marked: marked(frame.flags) };
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
