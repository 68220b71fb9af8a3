// The mesh: two states between which a slider goes, inside regions hatched, a colour map over all of it.
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, ShaderMaterial, Uint32BufferAttribute } from "three";

import type { Shown } from "./data";
import { KINDS } from "./kinds";
import { type ColourMap, textureOf } from "./maps";
import type { Surface } from "./surface";

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

  constructor({ triangles, numClothFaces, tints }: Surface, states: Shown[]) {
    const [first, last] = [states[0]!, states[states.length - 1]!];
    const geometry = this.geometry;
    geometry.setIndex(new Uint32BufferAttribute(triangles, 1));
    // Of one state both are the same, and go to the graphics card once.
    const own = (state: Shown) => new BufferAttribute(state.positions.slice(), 3);
    const [before, inside] = [own(first), insides(first)];
    geometry.setAttribute("position", before);
    geometry.setAttribute("after", first === last ? before : own(last));
    geometry.setAttribute("tint", new BufferAttribute(tints, 3));
    geometry.setAttribute("value", new BufferAttribute(new Float32Array(first.positions.length / 3), 1));
    geometry.setAttribute("inside", inside);
    geometry.setAttribute("insideAfter", first === last ? inside : insides(last));
    this.materials = [material(1), material(0.45)];
    const numOfCloth = 3 * numClothFaces;
    geometry.addGroup(0, numOfCloth, 0);
    if (numOfCloth < triangles.length) geometry.addGroup(numOfCloth, triangles.length - numOfCloth, 1);
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

  /** As many other states of the same mesh. */
  setStates(states: Shown[]) {
    const names = [["position", "inside"] as const, ["after", "insideAfter"] as const];
    states.slice(0, 2).forEach((state, number) => {
      const [place, inside] = names[number]!.map((name) => this.geometry.getAttribute(name) as BufferAttribute);
      place!.copyArray(state.positions).needsUpdate = true;
      colourInside(inside!.array as Uint8Array, state.inside);
      inside!.needsUpdate = true;
    });
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

/** For each vertex inside the colour of its path, and 1. */
function insides(state: Shown): BufferAttribute {
  const colours = new Uint8Array((state.positions.length / 3) * 4);
  colourInside(colours, state.inside);
  return new BufferAttribute(colours, 4, true);
}

const COLOURS = KINDS.map((kind) => [...rgb(kind.colour), 255]);
const NOTHING = [0, 0, 0, 0];

function colourInside(colours: Uint8Array, inside: Uint8Array) {
  inside.forEach((number, vertex) => colours.set(COLOURS[number - 1] ?? NOTHING, 4 * vertex));
}

export function rgb(colour: string): [number, number, number] {
  const value = parseInt(colour.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
