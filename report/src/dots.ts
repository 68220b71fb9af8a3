// Marked vertices in the picture, each kind with its marker.
import { BufferAttribute, BufferGeometry, CanvasTexture, Points, PointsMaterial } from "three";

import { DOTS, type DotName, type Marker, drawMarker } from "./kinds";

const TEXTURES = new Map<string, CanvasTexture>();

/** A marker with a light rim, as a texture. */
export function markerTexture(marker: Marker, colour: string): CanvasTexture {
  const key = `${marker} ${colour}`;
  const known = TEXTURES.get(key);
  if (known) return known;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  drawMarker(canvas.getContext("2d")!, marker, colour, 32, 32, 23);
  const texture = new CanvasTexture(canvas);
  TEXTURES.set(key, texture);
  return texture;
}

export class Dots {
  readonly points: Points<BufferGeometry, PointsMaterial>;

  constructor(
    readonly name: DotName,
    vertices: ArrayLike<number>,
    positions: Float32Array,
  ) {
    const places = new Float32Array(3 * vertices.length);
    for (let i = 0; i < vertices.length; i++) {
      places.set(positions.subarray(3 * vertices[i]!, 3 * vertices[i]! + 3), 3 * i);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(places, 3));
    const { marker, colour } = DOTS[name];
    const material = new PointsMaterial({
      map: markerTexture(marker, colour),
      sizeAttenuation: false,
      alphaTest: 0.5,
      // What is on the wrong side is hidden by its nature, and is to be seen.
      depthTest: name !== "body" && name !== "layer",
    });
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 3;
  }

  /** Before each picture: whether it shows, and device pixels to a pixel. */
  prepare(isVisible: boolean, ratio: number) {
    this.points.visible = isVisible;
    // The marker fills 46 of the 64 pixels of its texture.
    this.points.material.size = ((DOTS[this.name].size * 64) / 46) * ratio;
  }

  dispose() {
    this.points.geometry.dispose();
    this.points.material.dispose();
  }
}
