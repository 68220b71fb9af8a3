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
  const seen = new Map<string, number>();
  for (let vertex = 0; vertex < parent.length; vertex++) {
    const place = positions.subarray(3 * vertex, 3 * vertex + 3).join(" ");
    const first = seen.get(place);
    if (first === undefined) seen.set(place, vertex);
    else join(first, vertex);
  }
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
