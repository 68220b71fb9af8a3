// The mesh: two states between which a slider goes, inside regions hatched, a colour map over all of it.
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Mesh,
  ShaderMaterial,
  Uint32BufferAttribute,
  Vector2,
} from "three";

import type { Shown } from "./data";
import { KINDS } from "./kinds";
import { type ColourMap, textureOf } from "./maps";
import type { Surface } from "./surface";

// What a picture does not need is not compiled in: drawn in software, each number that a face hands on to its pixels
// takes time. MIXED: two states; MAPPED: a colour map.
const VERTEX = `
attribute vec3 tint;
attribute vec4 inside;
flat varying vec3 colour;
varying vec4 region;
#ifdef MIXED
attribute vec3 after;
attribute vec4 insideAfter;
uniform float mixing;
#endif
#ifdef MAPPED
attribute float value;
varying float amount;
#endif
void main() {
  vec3 at = position;
  region = inside;
#ifdef MIXED
  at = mix(at, after, mixing);
  region = mix(region, insideAfter, mixing);
#endif
#ifdef MAPPED
  amount = value;
#endif
  colour = tint;
  gl_Position = projectionMatrix * (modelViewMatrix * vec4(at, 1.0));
}`;

// The normal of a face by derivatives: facets are what the mesh has.
const FRAGMENT = `
uniform float opacity;
uniform mat4 projectionMatrix;
uniform vec2 resolution;
flat varying vec3 colour;
varying vec4 region;
#ifdef MAPPED
uniform sampler2D map;
varying float amount;
#endif
void main() {
  // Where the pixel is, as the camera sees it: of its depth, which it has anyway.
  vec2 across = 2.0 * gl_FragCoord.xy / resolution - 1.0;
  vec3 place = vec3(across / vec2(projectionMatrix[0][0], projectionMatrix[1][1]), -1.0) / gl_FragCoord.w;
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.6 + 0.3 * abs(normal.z) + 0.14 * dot(normal * sign(normal.z), vec3(-0.5, 0.75, 0.45));
#ifdef MAPPED
  vec3 base = texture2D(map, vec2(amount * 0.996 + 0.002, 0.5)).rgb;
  float fifths = amount * 5.0;
  float width = fwidth(fifths);
  float nearness = abs(fract(fifths + 0.5) - 0.5);
  if (width > 0.0 && width < 0.5 && nearness < 0.7 * width && amount > 0.02 && amount < 0.98) base *= 0.55;
  light = 0.4 + 0.6 * light;
#else
  vec3 base = colour;
  if (region.a > 0.5) {
    float stripe = mod(gl_FragCoord.x + gl_FragCoord.y, 8.0);
    base = mix(base, region.rgb / region.a, stripe < 3.0 ? 0.75 : 0.3);
  }
#endif
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
    const own = (state: Shown) => new BufferAttribute(state.positions.slice(), 3);
    geometry.setAttribute("position", own(first));
    geometry.setAttribute("tint", new BufferAttribute(tints, 3));
    geometry.setAttribute("inside", insides(first));
    const isMixed = first !== last;
    if (isMixed) {
      geometry.setAttribute("after", own(last));
      geometry.setAttribute("insideAfter", insides(last));
    }
    this.materials = [material(1, isMixed), material(0.45, isMixed)];
    const numOfCloth = 3 * numClothFaces;
    geometry.addGroup(0, numOfCloth, 0);
    if (numOfCloth < triangles.length) geometry.addGroup(numOfCloth, triangles.length - numOfCloth, 1);
    this.mesh = new Mesh(geometry, this.materials);
    this.mesh.frustumCulled = false;
    this.setSeeThrough(false);
  }

  /** Before each picture: its size in pixels that are drawn. */
  prepare(width: number, height: number) {
    for (const { uniforms } of this.materials) (uniforms["resolution"]!.value as Vector2).set(width, height);
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
    if (map && !this.geometry.hasAttribute("value")) {
      this.geometry.setAttribute("value", new BufferAttribute(new Float32Array(map.values.length), 1));
    }
    if (map) {
      (this.geometry.getAttribute("value") as BufferAttribute).copyArray(map.values).needsUpdate = true;
    }
    const [cloth] = this.materials as [ShaderMaterial];
    if (map) cloth.defines["MAPPED"] = "";
    else delete cloth.defines["MAPPED"];
    cloth.needsUpdate = true;
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

function material(opacity: number, isMixed: boolean): ShaderMaterial {
  const uniforms = {
    mixing: { value: 0 },
    map: { value: textureOf(null) },
    opacity: { value: opacity },
    resolution: { value: new Vector2(1, 1) },
  };
  // Paths lie in the surface: it stands back a little for them.
  const offset = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 };
  return new ShaderMaterial({
    uniforms,
    defines: isMixed ? { MIXED: "" } : {},
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

/** Four bytes of each type of path, counted from 1, as one number; 0 is inside of none, as is any other. */
const COLOURS = new Uint32Array(256);
KINDS.forEach((kind, number) => new Uint8Array(COLOURS.buffer, 4 * (number + 1)).set([...rgb(kind.colour), 255]));

function colourInside(colours: Uint8Array, inside: Uint8Array) {
  const whole = new Uint32Array(colours.buffer, colours.byteOffset, inside.length);
  for (let vertex = 0; vertex < inside.length; vertex++) whole[vertex] = COLOURS[inside[vertex]!]!;
}

export function rgb(colour: string): [number, number, number] {
  const value = parseInt(colour.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
