// The surface of a picture: its triangles, and a calm colour for each file, layer or piece.
import type { Part } from "./data";

const CLOTHS = [
  [0.93, 0.9, 0.84],
  [0.7, 0.8, 0.89],
  [0.82, 0.87, 0.78],
  [0.92, 0.82, 0.78],
  [0.86, 0.82, 0.92],
];
const BODY = [0.62, 0.62, 0.64];
/** Instead of the number of a colour. */
const IS_BODY = 255;

export interface Surface {
  /** Those of bodies last. */
  triangles: Uint32Array;
  numClothFaces: number;
  /** Red, green and blue of each vertex. */
  tints: Float32Array;
}

/** Of files: a colour for each, or for each piece where there is one file of cloth. */
export function surfaceOfParts(parts: Part[], triangles: Uint32Array, positions: Float32Array): Surface {
  const numbers = new Uint8Array(positions.length / 3);
  const cloth = parts.filter((part) => part.role !== "body");
  const pieces = cloth.length === 1 ? piecesOf(triangles, positions) : null;
  let at = 0;
  parts.forEach((part, number) => {
    for (let i = 0; i < part.num_vertices; i++, at++) {
      numbers[at] = part.role === "body" ? IS_BODY : (pieces ? pieces[at]! : number) % CLOTHS.length;
    }
  });
  return { triangles, numClothFaces: cloth.reduce((sum, part) => sum + part.num_faces, 0), tints: tints(numbers) };
}

/** Of a session: the layer of each vertex, or 255 for one of a body; or a colour for each piece. */
export function surfaceOfRoles(
  roles: Uint8Array | null,
  triangles: Uint32Array,
  numClothFaces: number,
  positions: Float32Array,
): Surface {
  const isLayered = roles?.some((role) => role > 0 && role !== IS_BODY) ?? false;
  const numbers = isLayered
    ? roles!
    : Uint8Array.from(piecesOf(triangles, positions), (piece) => piece % CLOTHS.length);
  const own = numbers.map((number, vertex) => (roles?.[vertex] === IS_BODY ? IS_BODY : number));
  return { triangles, numClothFaces, tints: tints(own) };
}

function tints(numbers: Uint8Array): Float32Array {
  const colours = new Float32Array(3 * numbers.length);
  numbers.forEach((number, vertex) => {
    colours.set(number === IS_BODY ? BODY : CLOTHS[number % CLOTHS.length]!, 3 * vertex);
  });
  return colours;
}

/** Calls `join` for the first of all vertices in one place, and each of the others. */
function joinPlaces(positions: Float32Array, join: (first: number, other: number) => void) {
  // Zeros of either sign are one place.
  const places = positions.map((value) => value + 0);
  const bits = new Uint32Array(places.buffer);
  const table = new Int32Array(2 ** Math.ceil(Math.log2(2 * positions.length + 1))).fill(-1);
  for (let vertex = 0; vertex < positions.length / 3; vertex++) {
    const [x, y, z] = [bits[3 * vertex]!, bits[3 * vertex + 1]!, bits[3 * vertex + 2]!];
    let hash = Math.imul(Math.imul(Math.imul(x, 0x9e3779b1) ^ y, 0x85ebca6b) ^ z, 0xc2b2ae35);
    hash ^= hash >>> 15;
    for (let slot = hash & (table.length - 1); ; slot = (slot + 1) & (table.length - 1)) {
      const first = table[slot]!;
      if (first < 0) {
        table[slot] = vertex;
        break;
      }
      if (bits[3 * first] === x && bits[3 * first + 1] === y && bits[3 * first + 2] === z) {
        join(first, vertex);
        break;
      }
    }
  }
}

/** For each vertex the number of its piece; vertices in one place are one. */
function piecesOf(triangles: Uint32Array, positions: Float32Array): Uint32Array {
  const parent = Uint32Array.from({ length: positions.length / 3 }, (_, vertex) => vertex);
  const root = (vertex: number): number => {
    while (parent[vertex] !== vertex) vertex = parent[vertex] = parent[parent[vertex]!]!;
    return vertex;
  };
  const join = (a: number, b: number) => {
    parent[root(b)] = root(a);
  };
  joinPlaces(positions, join);
  for (let i = 0; i < triangles.length; i += 3) {
    join(triangles[i]!, triangles[i + 1]!);
    join(triangles[i]!, triangles[i + 2]!);
  }
  const numbers = new Map<number, number>();
  return parent.map((_, vertex) => {
    const own = root(vertex);
    if (!numbers.has(own)) numbers.set(own, numbers.size);
    return numbers.get(own)!;
  });
}
