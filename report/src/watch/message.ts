// Messages of untangled watch: a JSON document and arrays of numbers. Written by src/cli/watch/message.rs and
// observed/frame.rs.

/** What does not change from frame to frame. */
export interface MeshMessage {
  numVertices: number;
  /** Those of bodies last. */
  triangles: Uint32Array;
  numClothFaces: number;
  /** For each vertex its layer, or 255 for one of a body; nothing where there are neither. */
  roles: Uint8Array | null;
}

/** One pair of corresponding intersection paths. */
export interface PathMessage {
  pair_type: string;
  length_m: number;
  /** What the page says of it besides, row by row. */
  facts: [string, string][];
  /** Why nothing is done about it, in words. */
  reason?: string;
}

/** Vertices inside of a body, or behind an inner layer, and how deep the deepest is in metres. */
export interface WrongMessage {
  kind: "body" | "layer";
  num_vertices: number;
  depth_m: number;
}

/** Numbers of a frame. Times in microseconds. */
export interface FrameHeader {
  frame: number;
  /** What is wrong with the frame, in words. */
  refused?: string;
  /** `displacement`, `force`, `acceleration` or `velocity`, and its unit. */
  correction: string;
  unit: string;
  /** Nothing where there is no body, and one layer. */
  wrong?: WrongMessage[];
  counts: Record<string, number>;
  contour_length_m: number;
  stage_us: Record<string, number>;
  latency_us: number | null;
  simulated_s: number;
  num_dropped: number;
}

export interface FrameMessage extends FrameHeader {
  /** When it came, in milliseconds of the page. */
  at: number;
  /** Read from the bytes again where another frame's were asked for last: all that many small objects take long. */
  readonly paths: PathMessage[];
  positions: Float32Array;
  /** Bits of `FLAGS`. */
  flags: Uint8Array;
  /** For each vertex the number of its type of path, counted from 1; 0 where it is inside of none. */
  inside: Uint8Array;
  corrected: Uint32Array;
  /** Three for each of `corrected`. */
  corrections: Float32Array;
  points: Float32Array;
  /** Path, first point, number of points. */
  lines: Uint32Array;
  numBytes: number;
}

export const FLAGS = { masked: 1, clamped: 2, pinned: 4, body: 8, layer: 16 } as const;

type Arrays = Record<string, [kind: "u8" | "u32" | "f32", offset: number, count: number]>;

type Header = Record<string, unknown> & { arrays: Arrays };

function headerOf(buffer: ArrayBuffer): { header: Header; length: number } {
  const length = new DataView(buffer).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, 4, length));
  return { header: JSON.parse(text) as Header, length };
}

function read(buffer: ArrayBuffer) {
  const { header, length } = headerOf(buffer);
  const place = (name: string) => {
    const [, offset, count] = header.arrays[name] ?? ["u8", 0, 0];
    return [4 + length + offset, count] as const;
  };
  return {
    header,
    bytes: (name: string) => new Uint8Array(buffer, ...place(name)),
    whole: (name: string) => new Uint32Array(buffer, ...place(name)),
    singles: (name: string) => new Float32Array(buffer, ...place(name)),
  };
}

export function readMesh(buffer: ArrayBuffer): MeshMessage {
  const { header, bytes, whole } = read(buffer);
  const numVertices = Number(header["num_vertices"]);
  const roles = bytes("roles");
  const given = whole("triangles");
  const isBody = (face: number) => roles.length > 0 && roles[given[3 * face]!] === 255;
  const faces = Array.from({ length: given.length / 3 }, (_, face) => face);
  const cloth = faces.filter((face) => !isBody(face));
  const triangles = new Uint32Array(given.length);
  [...cloth, ...faces.filter(isBody)].forEach((face, at) =>
    triangles.set(given.subarray(3 * face, 3 * face + 3), 3 * at),
  );
  return { numVertices, triangles, numClothFaces: cloth.length, roles: roles.length > 0 ? roles : null };
}

/** Those that were asked for last. */
let lastPaths: { buffer: ArrayBuffer; paths: PathMessage[] } | null = null;

export function readFrame(buffer: ArrayBuffer, at: number): FrameMessage {
  const { header, bytes, whole, singles } = read(buffer);
  const { paths, ...own } = header as unknown as FrameHeader & { paths: PathMessage[] };
  lastPaths = { buffer, paths };
  return {
    ...own,
    at,
    get paths() {
      if (lastPaths?.buffer !== buffer) {
        lastPaths = { buffer, paths: (headerOf(buffer).header as unknown as { paths: PathMessage[] }).paths };
      }
      return lastPaths.paths;
    },
    positions: singles("positions"),
    flags: bytes("flags"),
    inside: bytes("inside"),
    corrected: whole("corrected"),
    corrections: singles("corrections"),
    points: singles("points"),
    lines: whole("lines"),
    numBytes: buffer.byteLength,
  };
}
