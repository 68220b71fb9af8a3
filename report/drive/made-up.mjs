// A server in place of untangled watch, for drive/picture.mjs: a made-up session whose frames are there as fast as they
// are asked for, so that nothing is measured but the page.
import { readFileSync } from "node:fs";
import { createServer } from "node:http";

const built = (name) => readFileSync(new URL(`../built/${name}`, import.meta.url));
const PAGE =
  '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>made up</title><link rel="icon" href="data:,">' +
  '<link rel="stylesheet" href="watch.css"></head><body><div id="page"></div><script src="watch.js"></script></body>';
const KINDS = ["LL", "BLI", "CLOSED/CLOSED", "BB/II"];
const NUMBERS = [3, 4, 1, 8];

/** As src/cli/watch/message.rs writes them. */
function message(header, arrays) {
  const places = {};
  const parts = [];
  let at = 0;
  for (const [name, [kind, array]] of Object.entries(arrays)) {
    places[name] = [kind, at, array.length];
    const bytes = Buffer.from(array.buffer, array.byteOffset, array.byteLength);
    parts.push(bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4));
    at += bytes.length + ((4 - (bytes.length % 4)) % 4);
  }
  let text = JSON.stringify({ ...header, arrays: places });
  text += " ".repeat((4 - (Buffer.byteLength(text) % 4)) % 4);
  const length = Buffer.alloc(4);
  length.writeUInt32LE(Buffer.byteLength(text));
  return Buffer.concat([length, Buffer.from(text), ...parts]);
}

/** A sheet of `side` by `side` quads. */
export class MadeUp {
  constructor(side) {
    this.side = side;
    const n = side + 1;
    this.numVertices = n * n;
    this.triangles = new Uint32Array(6 * side * side);
    for (let y = 0, at = 0; y < side; y++) {
      for (let x = 0; x < side; x++, at += 6) {
        const a = y * n + x;
        this.triangles.set([a, a + 1, a + n, a + n, a + 1, a + n + 1], at);
      }
    }
  }

  mesh() {
    const arrays = { triangles: ["u32", this.triangles], roles: ["u8", new Uint8Array(0)] };
    return message({ num_vertices: this.numVertices }, arrays);
  }

  /** A frame in which waves run over the sheet; some paths, 3,000 vertices inside, as many corrections. */
  frame(number) {
    const { side, numVertices } = this;
    const [n, time] = [side + 1, number / 20];
    const positions = new Float32Array(3 * numVertices);
    for (let vertex = 0; vertex < numVertices; vertex++) {
      const [x, y] = [(vertex % n) / side, Math.floor(vertex / n) / side];
      positions.set([x, y, 0.1 * Math.sin(9 * x + time) * Math.cos(7 * y - time)], 3 * vertex);
    }
    const inside = new Uint8Array(numVertices);
    const corrected = Uint32Array.from({ length: 3000 }, (_, at) => 5 * at);
    const corrections = Float32Array.from({ length: 9000 }, (_, at) => (at % 3 === 2 ? 0.01 : 0));
    corrected.forEach((vertex) => (inside[vertex] = 1 + (vertex % 4)));
    const [points, lines, paths] = [[], [], []];
    for (let path = 0; path < 8; path++) {
      lines.push(path, points.length / 3, side + 1);
      for (let x = 0; x <= side; x++) {
        points.push(...positions.subarray(3 * (x + n * 12 * (path + 1)), 3 * (x + n * 12 * (path + 1)) + 3));
      }
      const facts = [["Vertices inside", "375"]];
      paths.push({ pair_type: KINDS[path % KINDS.length], length_m: 1 + path / 10, facts });
    }
    const header = {
      ...{ frame: number, correction: "force", unit: "N", paths, contour_length_m: 9 + Math.sin(time) },
      counts: { num_face_pairs: 1000, num_inside: 3000, num_paths: 8 },
      stage_us: { ingest: 90, intersect: 900, paths: 90, regions: 400, correspond: 700, respond: 90, total: 2300 },
      ...{ latency_us: 3000, simulated_s: time, num_dropped: 0 },
    };
    return message(header, {
      positions: ["f32", positions],
      flags: ["u8", new Uint8Array(numVertices)],
      inside: ["u8", inside],
      corrected: ["u32", corrected],
      corrections: ["f32", corrections],
      points: ["f32", Float32Array.from(points)],
      lines: ["u32", Uint32Array.from(lines)],
    });
  }

  /** Serves the page; gives back its address and how to end it. */
  async serve() {
    const frames = Array.from({ length: 40 }, (_, number) => this.frame(number + 1));
    const sessions = {
      ...{ schema: "untangled.watch/1", version: "0", daemon: "made-up", waiting: null },
      sessions: [
        {
          session: "1-1",
          host: "nobody",
          num_vertices: this.numVertices,
          num_faces: 2 * this.side ** 2,
          num_frames: 1,
        },
      ],
    };
    let serial = 0;
    const server = createServer(({ url }, answer) => {
      const what = url.slice(1).split("?")[0];
      if (what === "frame") answer.setHeader("Untangled-Serial", String(++serial));
      if (what === "watch.css") answer.setHeader("Content-Type", "text/css");
      if (what === "") answer.setHeader("Content-Type", "text/html");
      const answers = {
        "": () => PAGE,
        "watch.js": () => built(what),
        "watch.css": () => built(what),
        sessions: () => JSON.stringify(sessions),
        mesh: () => this.mesh(),
        frame: () => frames[serial % frames.length],
      };
      answer.end(answers[what]?.() ?? "");
    });
    await new Promise((done) => server.listen(0, "127.0.0.1", done));
    return { address: `http://127.0.0.1:${server.address().port}/`, end: () => server.close() };
  }
}
