// Intersection paths in the picture: lines by type, faint where cloth hides them, and a marker on each path.
import { BufferAttribute, BufferGeometry, Group, Points, PointsMaterial, Vector3 } from "three";

import type { Shown } from "./data";
import { markerTexture } from "./dots";
import { DASHES, type Kind, KINDS } from "./kinds";
import { type LineStyle, Lines, quadsOf } from "./lines";

const WIDTH = 3.2;
/** Most markers: more would be a carpet. The longest paths have them. */
const MOST_MARKERS = 1500;

/** Corners of the segments of some paths, two by two. */
function segments(state: Shown, isWanted: (path: number) => boolean): Float32Array {
  const lines = state.lines.filter((line) => isWanted(line.path));
  const count = lines.reduce((sum, line) => sum + line.count - 1, 0);
  const result = new Float32Array(6 * count);
  let at = 0;
  for (const { first, count } of lines) {
    for (let i = first; i + 1 < first + count; i++, at += 6) {
      for (let k = 0; k < 6; k++) result[at + k] = state.points[3 * i + k]!;
    }
  }
  return result;
}

/** For each path the place in the middle of its longest line, and how far its points are from there at most. */
export function placesOf(state: Shown): { place: Vector3; radius: number }[] {
  const longest = new Map<number, { first: number; count: number }>();
  for (const line of state.lines) {
    if (line.count > (longest.get(line.path)?.count ?? 0)) longest.set(line.path, line);
  }
  const point = (i: number) => new Vector3().fromArray(state.points, 3 * i);
  const places = state.paths.map((_, path) => {
    const line = longest.get(path) ?? { first: 0, count: 0 };
    const place =
      line.count === 2
        ? point(line.first).lerp(point(line.first + 1), 0.5)
        : line.count > 0
          ? point(line.first + (line.count >> 1))
          : new Vector3();
    return { place, radius: 0 };
  });
  for (const { path, first, count } of state.lines) {
    const own = places[path]!;
    let square = own.radius ** 2;
    for (let i = 3 * first; i < 3 * (first + count); i += 3) {
      const [x, y, z] = [state.points[i]!, state.points[i + 1]!, state.points[i + 2]!];
      square = Math.max(square, (x - own.place.x) ** 2 + (y - own.place.y) ** 2 + (z - own.place.z) ** 2);
    }
    own.radius = Math.sqrt(square);
  }
  return places;
}

/** How the picture is seen: size in pixels, device pixels to one of them, pixels to a metre, where sight begins. */
export interface Sight {
  width: number;
  height: number;
  ratio: number;
  pixelsPerMetre: number;
  near: number;
}

/** The paths of one state. */
export class Contours {
  readonly group = new Group();
  readonly places: { place: Vector3; radius: number }[];
  private readonly byKind = new Map<string, Group>();
  private lines: Lines[] = [];
  private readonly points: PointsMaterial[] = [];
  private readonly picked = new Group();
  private pickedLines: Lines[] = [];

  constructor(private readonly state: Shown) {
    this.places = placesOf(state);
    const order = state.paths.map((_, path) => path);
    order.sort((a, b) => state.paths[b]!.length_m - state.paths[a]!.length_m);
    const marked = order.slice(0, MOST_MARKERS);
    for (const kind of KINDS) {
      const isOwn = (path: number) => state.paths[path]?.pair_type === kind.name;
      const corners = segments(state, isOwn);
      if (corners.length === 0) continue;
      const group = new Group();
      const quads = quadsOf(corners);
      const style = { colour: kind.colour, width: WIDTH, dash: DASHES[kind.dash] };
      const hidden = this.line(quads, { ...style, isOnTop: true, opacity: 0.3 }, 1);
      const open = this.line(quads, { ...style, isOnTop: false, opacity: 1 }, 2);
      this.lines.push(hidden, open);
      group.add(hidden.mesh, open.mesh);
      group.add(this.markers(kind, marked.filter(isOwn)));
      this.byKind.set(kind.name, group);
      this.group.add(group);
    }
    this.group.add(this.picked);
  }

  private line(quads: BufferGeometry, style: LineStyle, order: number): Lines {
    const lines = new Lines(quads, style);
    lines.mesh.renderOrder = order;
    return lines;
  }

  private markers(kind: Kind, paths: number[]): Points {
    const geometry = new BufferGeometry();
    const places = new Float32Array(paths.flatMap((path) => this.places[path]!.place.toArray()));
    geometry.setAttribute("position", new BufferAttribute(places, 3));
    const material = new PointsMaterial({
      size: 17,
      sizeAttenuation: false,
      map: markerTexture(kind.marker, kind.colour),
      transparent: true,
      depthTest: false,
      alphaTest: 0.05,
    });
    const points = new Points(geometry, material);
    points.frustumCulled = false;
    points.renderOrder = 4;
    this.points.push(material);
    return points;
  }

  /** Marks one path, or none: a light rim under it, and its line on top of all cloth. */
  pick(path: number | null) {
    this.pickedLines.forEach((lines) => lines.dispose());
    this.picked.clear();
    const kind = KINDS.find((kind) => path !== null && kind.name === this.state.paths[path]?.pair_type);
    this.pickedLines = [];
    if (!kind) return;
    const quads = quadsOf(segments(this.state, (other) => other === path));
    const style = { isOnTop: true, opacity: 1 };
    this.pickedLines = [
      this.line(quads, { ...style, colour: "#ffe14d", width: 3 * WIDTH, dash: null }, 5),
      this.line(quads, { ...style, colour: kind.colour, width: 1.3 * WIDTH, dash: DASHES[kind.dash] }, 6),
    ];
    this.pickedLines.forEach((lines) => this.picked.add(lines.mesh));
  }

  /** Gives back what the graphics card holds. */
  dispose() {
    this.group.traverse((object) => {
      const { geometry, material } = object as Points;
      geometry?.dispose();
      (material as PointsMaterial | undefined)?.dispose();
    });
  }

  /** Shows or hides a type. */
  setKind(name: string, isShown: boolean) {
    const group = this.byKind.get(name);
    if (group) group.visible = isShown;
  }

  isShown(path: number): boolean {
    return this.byKind.get(this.state.paths[path]!.pair_type)?.visible ?? false;
  }

  /** Before each picture: how much of it shows, the picture in pixels, and pixels to a metre, for dashes. */
  prepare(opacity: number, sight: Sight) {
    this.group.visible = opacity > 0;
    for (const lines of [...this.lines, ...this.pickedLines]) {
      lines.prepare(opacity, sight.width, sight.height, sight.pixelsPerMetre, sight.near);
    }
    for (const material of this.points) {
      material.opacity = opacity;
      material.size = 17 * sight.ratio;
    }
  }
}
