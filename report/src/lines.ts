// Lines of some pixels in width, with dashes: a quad for each segment. (The lines that come with three.js have round
// ends and much else; in software they took four fifths of a picture of 5,000 segments.)
import { BufferAttribute, BufferGeometry, Color, Mesh, ShaderMaterial, Vector2 } from "three";

const VERTEX = `
// The start stands in the position.
attribute vec3 end;
attribute vec2 corner;
attribute vec2 distances;
uniform vec2 resolution;
uniform float width;
uniform float cap;
uniform float pixelsPerMetre;
uniform float near;
varying float travelled;
void main() {
  vec4 a = modelViewMatrix * vec4(position, 1.0);
  vec4 b = modelViewMatrix * vec4(end, 1.0);
  vec2 at = distances;
  if (a.z > -near && b.z > -near) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  // What is behind the camera is cut off.
  if (a.z > -near) {
    float t = (-near - a.z) / (b.z - a.z);
    a = mix(a, b, t);
    at.x = mix(at.x, at.y, t);
  } else if (b.z > -near) {
    float t = (-near - b.z) / (a.z - b.z);
    b = mix(b, a, t);
    at.y = mix(at.y, at.x, t);
  }
  vec4 first = projectionMatrix * a;
  vec4 last = projectionMatrix * b;
  vec2 along = (last.xy / last.w - first.xy / first.w) * resolution;
  float size = length(along);
  along = size > 1e-6 ? along / size : vec2(1.0, 0.0);
  bool isEnd = corner.x > 0.5;
  vec4 place = isEnd ? last : first;
  float beyond = (isEnd ? 1.0 : -1.0) * cap * 0.5 * width;
  vec2 offset = along * beyond + vec2(-along.y, along.x) * corner.y * 0.5 * width;
  place.xy += 2.0 * offset / resolution * place.w;
  travelled = (isEnd ? at.y : at.x) * pixelsPerMetre + beyond;
  gl_Position = place;
}`;

const FRAGMENT = `
uniform vec3 colour;
uniform float opacity;
uniform vec2 dash;
varying float travelled;
void main() {
  if (dash.y > 0.0 && mod(travelled, dash.x + dash.y) > dash.x) discard;
  gl_FragColor = vec4(colour, opacity);
}`;

/** Of a quad: whether a corner is at the end of its segment, and on which side; and its two triangles. */
const CORNERS = [0, -1, 1, -1, 0, 1, 1, 1];
const TRIANGLES = [0, 1, 2, 2, 1, 3];

export interface LineStyle {
  colour: string;
  /** In pixels. */
  width: number;
  /** Lengths of dash and gap in pixels; nothing for a solid line. */
  dash: [number, number] | null;
  /** Where the cloth hides it, too. */
  isOnTop: boolean;
  opacity: number;
}

/** A quad for each segment. `corners` are those of segments, two by two. */
export function quadsOf(corners: Float32Array): BufferGeometry {
  const count = corners.length / 6;
  const [starts, ends] = [new Float32Array(12 * count), new Float32Array(12 * count)];
  const [distances, corner] = [new Float32Array(8 * count), new Float32Array(8 * count)];
  const index = new Uint32Array(6 * count);
  let travelled = 0;
  for (let i = 0; i < count; i++) {
    const from = travelled;
    let square = 0;
    for (let axis = 0; axis < 3; axis++) {
      const [start, end] = [corners[6 * i + axis]!, corners[6 * i + 3 + axis]!];
      square += (end - start) ** 2;
      for (let at = 12 * i + axis; at < 12 * (i + 1); at += 3) {
        starts[at] = start;
        ends[at] = end;
      }
    }
    travelled += Math.sqrt(square);
    for (let at = 8 * i; at < 8 * (i + 1); at += 2) {
      distances[at] = from;
      distances[at + 1] = travelled;
    }
    corner.set(CORNERS, 8 * i);
    for (let k = 0; k < 6; k++) index[6 * i + k] = 4 * i + TRIANGLES[k]!;
  }
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(index, 1));
  geometry.setAttribute("position", new BufferAttribute(starts, 3));
  geometry.setAttribute("end", new BufferAttribute(ends, 3));
  geometry.setAttribute("distances", new BufferAttribute(distances, 2));
  geometry.setAttribute("corner", new BufferAttribute(corner, 2));
  return geometry;
}

export class Lines {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;

  /** Lines of the same quads may share them. */
  constructor(
    geometry: BufferGeometry,
    private readonly style: LineStyle,
  ) {
    const material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthTest: !style.isOnTop,
      depthWrite: false,
      uniforms: {
        resolution: { value: new Vector2(1, 1) },
        width: { value: style.width },
        // Half a width beyond the ends closes corners, where that does not blend twice.
        cap: { value: style.opacity < 1 ? 0 : 1 },
        pixelsPerMetre: { value: 1 },
        near: { value: 0 },
        colour: { value: new Color(style.colour) },
        opacity: { value: 1 },
        dash: { value: new Vector2(...(style.dash ?? [0, 0])) },
      },
    });
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
  }

  /** Before each picture: how much of it shows, its size in pixels, pixels to a metre, and where sight begins. */
  prepare(opacity: number, width: number, height: number, pixelsPerMetre: number, near: number) {
    const { uniforms } = this.mesh.material;
    uniforms["opacity"]!.value = opacity * this.style.opacity;
    (uniforms["resolution"]!.value as Vector2).set(width, height);
    uniforms["pixelsPerMetre"]!.value = pixelsPerMetre;
    uniforms["near"]!.value = near;
  }

  dispose() {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
