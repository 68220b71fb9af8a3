// Corrections as arrows: some pixels wide, as long as they are large. The largest of the last seconds has a length of
// its own, by which all others are measured. Each arrow has corners of its own: an instance costs as much as a call to
// draw, where that is done in software.
import { BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, Mesh, ShaderMaterial, Vector2 } from "three";

import type { Sight } from "../contours";
import type { Overlay } from "../view";
import type { FrameMessage } from "./message";
import { ARROW } from "./palette";

/** More would be a carpet; of more, each so many-th is drawn. Fewer where processors draw. */
const MOST = 1200;
const MOST_IN_SOFTWARE = 400;
/** Length of the longest arrow in parts of half of the cloth's diagonal. */
const LONGEST = 0.16;
/** What is left of the largest correction after each frame, where later ones are smaller. */
const FADE = 0.99;

/** Along, across, and whether it is of the head: four corners of the shaft, three of the head. */
const CORNERS = [0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0, 0, -1, 1, 1, 0, 1, 0, 1, 1];
const TRIANGLES = [0, 1, 2, 0, 2, 3, 4, 5, 6];
const NUM_CORNERS = CORNERS.length / 3;

const VERTEX = `
// The start stands in the position.
attribute vec3 corner;
attribute vec3 value;
uniform vec2 resolution;
uniform float scale;
uniform float width;
uniform float near;
void main() {
  vec4 a = modelViewMatrix * vec4(position, 1.0);
  vec4 b = modelViewMatrix * vec4(position + scale * value, 1.0);
  if (a.z > -near || b.z > -near) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  vec4 first = projectionMatrix * a;
  vec4 last = projectionMatrix * b;
  vec2 along = 0.5 * (last.xy / last.w - first.xy / first.w) * resolution;
  float size = length(along);
  // Those of a pixel are dots that say nothing.
  if (size < 1.5) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  vec2 direction = along / size;
  float head = min(5.0 * width, 0.7 * size);
  // A corner of the shaft, or of the head.
  bool isHead = corner.z > 0.5;
  float at = isHead ? size - head * (1.0 - corner.x) : corner.x * (size - head);
  float across = corner.y * (isHead ? 0.45 * head * (1.0 - corner.x) : 0.5 * width);
  vec4 place = mix(first, last, at / size);
  place.xy += 2.0 * across * vec2(-direction.y, direction.x) / resolution * place.w;
  place.z -= 1e-4 * place.w;
  gl_Position = place;
}`;

const FRAGMENT = `
uniform vec3 colour;
void main() {
  gl_FragColor = vec4(colour, 1.0);
}`;

export class Arrows implements Overlay {
  readonly object: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly starts: BufferAttribute;
  private readonly values: BufferAttribute;
  private readonly most: number;
  private largest = 0;
  /** Those that are not in the picture's buffers yet. */
  private next: { frame: FrameMessage; step: number } | null = null;

  /** `radius`: half of the cloth's diagonal, in metres. */
  constructor(
    private readonly radius: number,
    isSoftware: boolean,
  ) {
    const most = (this.most = isSoftware ? MOST_IN_SOFTWARE : MOST);
    this.starts = new BufferAttribute(new Float32Array(3 * NUM_CORNERS * most), 3);
    this.values = new BufferAttribute(new Float32Array(3 * NUM_CORNERS * most), 3);
    const [corners, index] = [new Float32Array(CORNERS.length * most), new Uint16Array(TRIANGLES.length * most)];
    for (let arrow = 0; arrow < most; arrow++) {
      corners.set(CORNERS, CORNERS.length * arrow);
      index.set(
        TRIANGLES.map((corner) => NUM_CORNERS * arrow + corner),
        TRIANGLES.length * arrow,
      );
    }
    const geometry = new BufferGeometry();
    geometry.setIndex(new BufferAttribute(index, 1));
    geometry.setAttribute("corner", new BufferAttribute(corners, 3));
    geometry.setAttribute("position", this.starts.setUsage(DynamicDrawUsage));
    geometry.setAttribute("value", this.values.setUsage(DynamicDrawUsage));
    geometry.setDrawRange(0, 0);
    const uniforms = {
      resolution: { value: new Vector2(1, 1) },
      scale: { value: 1 },
      width: { value: 1.4 },
      near: { value: 0 },
      colour: { value: new Color(ARROW) },
    };
    const material = new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms });
    this.object = new Mesh(geometry, material);
    this.object.frustumCulled = false;
  }

  /** Shows the corrections of a frame; gives back the largest. */
  show(frame: FrameMessage): number {
    const { corrected, corrections } = frame;
    let square = 0;
    for (let i = 0; i < corrections.length; i += 3) {
      square = Math.max(square, corrections[i]! ** 2 + corrections[i + 1]! ** 2 + corrections[i + 2]! ** 2);
    }
    const own = Math.sqrt(square);
    this.largest = Math.max(own, FADE * this.largest);
    this.next = { frame, step: this.step(corrected.length) };
    this.object.material.uniforms["scale"]!.value = this.largest > 0 ? (LONGEST * this.radius) / this.largest : 1;
    return own;
  }

  /** Of how many corrections one is drawn. */
  step(count: number): number {
    return Math.max(1, Math.ceil(count / this.most));
  }

  private fill({ corrected, corrections, positions }: FrameMessage, step: number) {
    const [starts, values] = [this.starts.array, this.values.array];
    let count = 0;
    for (let at = 0; at < corrected.length; at += step, count++) {
      const vertex = corrected[at]!;
      for (let axis = 0; axis < 3; axis++) {
        const [start, value] = [positions[3 * vertex + axis]!, corrections[3 * at + axis]!];
        for (let corner = 0, i = 3 * NUM_CORNERS * count + axis; corner < NUM_CORNERS; corner++, i += 3) {
          starts[i] = start;
          values[i] = value;
        }
      }
    }
    this.object.geometry.setDrawRange(0, TRIANGLES.length * count);
    for (const attribute of [this.starts, this.values]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 3 * NUM_CORNERS * count);
      attribute.needsUpdate = true;
    }
  }

  /** Fills the buffers, if it shows. */
  prepare({ width, height, near }: Sight) {
    if (!this.object.visible) return;
    if (this.next) this.fill(this.next.frame, this.next.step);
    this.next = null;
    const { uniforms } = this.object.material;
    (uniforms["resolution"]!.value as Vector2).set(width, height);
    uniforms["near"]!.value = near;
  }
}
