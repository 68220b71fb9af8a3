// The mesh: two states between which a slider goes, inside regions hatched, a colour map over all of it.
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, ShaderMaterial, Uint32BufferAttribute } from "three";

import type { Part, State } from "./data";
import { kindOf } from "./kinds";
import { type ColourMap, textureOf } from "./maps";

const CLOTHS = [
  [0.93, 0.9, 0.84],
  [0.7, 0.8, 0.89],
  [0.82, 0.87, 0.78],
  [0.92, 0.82, 0.78],
  [0.86, 0.82, 0.92],
];
const BODY = [0.62, 0.62, 0.64];

const VERTEX = `
attribute vec3 after;
attribute vec3 tint;
attribute float value;
attribute vec4 inside;
attribute vec4 insideAfter;
uniform float mixing;
varying vec3 place;
varying vec3 colour;
varying float amount;
varying vec4 region;
void main() {
  vec4 seen = modelViewMatrix * vec4(mix(position, after, mixing), 1.0);
  place = seen.xyz;
  colour = tint;
  amount = value;
  region = mix(inside, insideAfter, mixing);
  gl_Position = projectionMatrix * seen;
}`;

// The normal of a face by derivatives: facets are what the mesh has.
const FRAGMENT = `
uniform sampler2D map;
uniform bool isMapped;
uniform float opacity;
varying vec3 place;
varying vec3 colour;
varying float amount;
varying vec4 region;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.6 + 0.3 * abs(normal.z) + 0.14 * dot(normal * sign(normal.z), vec3(-0.5, 0.75, 0.45));
  vec3 base = colour;
  if (isMapped) {
    base = texture2D(map, vec2(amount * 0.996 + 0.002, 0.5)).rgb;
    float fifths = amount * 5.0;
    float width = fwidth(fifths);
    float nearness = abs(fract(fifths + 0.5) - 0.5);
    if (width > 0.0 && width < 0.5 && nearness < 0.7 * width && amount > 0.02 && amount < 0.98) base *= 0.55;
    light = 0.4 + 0.6 * light;
  } else if (region.a > 0.5) {
    vec3 own = region.rgb / region.a;
    float stripe = mod(gl_FragCoord.x + gl_FragCoord.y, 8.0);
    base = stripe < 3.0 ? mix(base, own, 0.75) : mix(base, own, 0.3);
  }
  if (!gl_FrontFacing) base *= 0.84;
  gl_FragColor = vec4(base * light, opacity);
}`;

export class Cloth {
  readonly mesh: Mesh;
  private readonly geometry = new BufferGeometry();
  private readonly materials: ShaderMaterial[];

  constructor(parts: Part[], triangles: Uint32Array, states: State[]) {
    const [first, last] = [states[0]!, states[states.length - 1]!];
    const geometry = this.geometry;
    geometry.setIndex(new Uint32BufferAttribute(triangles, 1));
    geometry.setAttribute("position", new BufferAttribute(first.positions, 3));
    geometry.setAttribute("after", new BufferAttribute(last.positions, 3));
    geometry.setAttribute("tint", tints(parts, triangles, first.positions));
    geometry.setAttribute("value", new BufferAttribute(new Float32Array(first.positions.length / 3), 1));
    geometry.setAttribute("inside", insides(first));
    geometry.setAttribute("insideAfter", insides(last));
    this.materials = [material(1), material(0.45)];
    const cloth = parts.filter((part) => part.role !== "body").reduce((sum, part) => sum + part.num_faces, 0);
    geometry.addGroup(0, 3 * cloth, 0);
    if (3 * cloth < triangles.length) geometry.addGroup(3 * cloth, triangles.length - 3 * cloth, 1);
    this.mesh = new Mesh(geometry, this.materials);
    this.mesh.frustumCulled = false;
    this.setSeeThrough(false);
  }

  setMixing(mixing: number) {
    for (const { uniforms } of this.materials) uniforms["mixing"]!.value = mixing;
  }

  /** Bodies are always seen through a little, so that what is inside of them shows. */
  setSeeThrough(isSeeThrough: boolean) {
    const [cloth, body] = this.materials as [ShaderMaterial, ShaderMaterial];
    for (const [material, opacity] of [
      [cloth, isSeeThrough ? 0.4 : 1],
      [body, isSeeThrough ? 0.2 : 0.55],
    ] as const) {
      material.uniforms["opacity"]!.value = opacity;
      material.transparent = opacity < 1;
      material.depthWrite = opacity === 1;
      material.needsUpdate = true;
    }
  }

  setMap(map: ColourMap | null) {
    if (map) {
      (this.geometry.getAttribute("value") as BufferAttribute).copyArray(map.values).needsUpdate = true;
    }
    const [cloth] = this.materials as [ShaderMaterial];
    cloth.uniforms["isMapped"]!.value = map !== null;
    cloth.uniforms["map"]!.value = textureOf(map);
  }

  /** Other states of the same mesh. */
  setStates(states: State[]) {
    const [first, last] = [states[0]!, states[states.length - 1]!];
    for (const [name, state] of [
      ["position", first],
      ["after", last],
    ] as const) {
      (this.geometry.getAttribute(name) as BufferAttribute).copyArray(state.positions).needsUpdate = true;
    }
    for (const [name, state] of [
      ["inside", first],
      ["insideAfter", last],
    ] as const) {
      (this.geometry.getAttribute(name) as BufferAttribute).copyArray(insides(state).array).needsUpdate = true;
    }
  }
}

function material(opacity: number): ShaderMaterial {
  const uniforms = {
    mixing: { value: 0 },
    map: { value: textureOf(null) },
    isMapped: { value: false },
    opacity: { value: opacity },
  };
  // Paths lie in the surface: it stands back a little for them.
  const offset = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 };
  return new ShaderMaterial({
    uniforms,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: DoubleSide,
    ...offset,
  });
}

/** A calm colour for each file, or for each piece where there is one file of cloth. */
function tints(parts: Part[], triangles: Uint32Array, positions: Float32Array): BufferAttribute {
  const colours = new Float32Array(positions.length);
  const pieces = parts.filter((part) => part.role !== "body").length === 1 ? piecesOf(triangles, positions) : null;
  let at = 0;
  parts.forEach((part, number) => {
    for (let i = 0; i < part.num_vertices; i++, at++) {
      const colour = part.role === "body" ? BODY : CLOTHS[(pieces ? pieces[at]! : number) % CLOTHS.length]!;
      colours.set(colour, 3 * at);
    }
  });
  return new BufferAttribute(colours, 3);
}

/** For each vertex the number of its piece; vertices in one place are one. */
export function piecesOf(triangles: Uint32Array, positions: Float32Array): Uint32Array {
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

/** For each vertex inside the colour of its path, and 1. */
function insides(state: State): BufferAttribute {
  const regions = new Uint8Array((state.positions.length / 3) * 4);
  for (const path of state.paths) {
    const colour = rgb(kindOf(path.pair_type).colour);
    for (const copy of path.copies) {
      for (const vertex of copy.inside_vertices ?? []) regions.set([...colour, 255], 4 * vertex);
    }
  }
  return new BufferAttribute(regions, 4, true);
}

export function rgb(colour: string): [number, number, number] {
  const value = parseInt(colour.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
