// The picture: cloth, paths, and vertices on the wrong side; drawn when something changes, not all the time.
import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  ColorManagement,
  LinearSRGBColorSpace,
  Points,
  PointsMaterial,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";

import { OrbitCamera, type Up, likelyUp, steer } from "./camera";
import { Cloth } from "./cloth";
import { Contours } from "./contours";
import type { PageData, State } from "./data";
import { whole } from "./data";
import type { ColourMap } from "./maps";

export interface Picked {
  path: number | null;
  vertex: number | null;
}

export class View {
  readonly canvas: HTMLCanvasElement;
  readonly orbit: OrbitCamera;
  readonly up: Up;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly cloth: Cloth;
  private contours: Contours[] = [];
  private dots: Points[][] = [];
  private readonly hidden = new Set<string>();
  private mixing = 0;
  private isAsked = false;
  private isSized = false;

  constructor(
    private readonly page: PageData,
    private states: State[],
    onPick: (picked: Picked) => void,
  ) {
    // Colours are those of the legend, to the bit.
    ColorManagement.enabled = false;
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setClearColor(0, 0);
    // To ask whether shaders are right waits for them.
    this.renderer.debug.checkShaderErrors = false;
    this.canvas = this.renderer.domElement;
    this.orbit = new OrbitCamera(() => this.draw());
    this.cloth = new Cloth(page.mesh.parts, whole(page.mesh.triangles), states);
    this.scene.add(this.cloth.mesh);
    this.showFound();
    const { centre, size } = boxOf(states);
    this.up = likelyUp(size);
    this.orbit.frame(centre, size.multiplyScalar(0.5), this.up);
    steer(this.canvas, this.orbit, (x, y) => onPick(this.find(x, y)));
    new ResizeObserver(() => this.resize()).observe(this.canvas);
  }

  /** Other states of the same mesh. */
  setStates(states: State[]) {
    this.states = states;
    this.cloth.setStates(states);
    for (const contours of this.contours) {
      this.scene.remove(contours.group);
      contours.dispose();
    }
    for (const points of this.dots.flat()) {
      this.scene.remove(points);
      points.geometry.dispose();
    }
    this.showFound();
    this.draw();
  }

  private showFound() {
    this.contours = this.states.map((state) => new Contours(state));
    for (const contours of this.contours) {
      this.scene.add(contours.group);
      for (const name of this.hidden) contours.setKind(name, false);
    }
    this.dots = this.states.map((state) => this.dotsOf(state, this.page.mesh.pinned));
  }

  /** Vertices on the wrong side, and pinned ones. */
  private dotsOf(state: State, pinned: number[]): Points[] {
    const rows: [number[], number, number][] = [[pinned, 0x000000, 5]];
    // Discs inside of a body, squares behind a layer.
    for (const wrong of state.wrongSides) {
      rows.push(wrong.kind === "body" ? [wrong.vertices, 0xa000a0, 8] : [wrong.vertices, 0x006400, 6]);
    }
    return rows
      .filter(([vertices]) => vertices.length > 0)
      .map(([vertices, colour, size]) => {
        const geometry = new BufferGeometry();
        const places = new Float32Array(vertices.flatMap((vertex) => [...placeOf(state, vertex)]));
        geometry.setAttribute("position", new BufferAttribute(places, 3));
        const material = new PointsMaterial({
          color: colour,
          size,
          sizeAttenuation: false,
          depthTest: vertices === pinned,
        });
        if (size === 8) {
          material.map = discTexture();
          material.alphaTest = 0.5;
        }
        const points = new Points(geometry, material);
        material.userData = { size };
        points.frustumCulled = false;
        points.renderOrder = 3;
        this.scene.add(points);
        return points;
      });
  }

  /** 0 is the first state, 1 the last. */
  setMixing(mixing: number) {
    this.mixing = mixing;
    this.cloth.setMixing(mixing);
    this.draw();
  }

  setMap(map: ColourMap | null) {
    this.cloth.setMap(map);
    this.draw();
  }

  setSeeThrough(isSeeThrough: boolean) {
    this.cloth.setSeeThrough(isSeeThrough);
    this.draw();
  }

  setKind(name: string, isShown: boolean) {
    if (isShown) this.hidden.delete(name);
    else this.hidden.add(name);
    this.contours.forEach((contours) => contours.setKind(name, isShown));
    this.draw();
  }

  /** Marks a path of a state, and looks at it. */
  pickPath(state: number, path: number | null, isSought: boolean) {
    this.contours.forEach((contours, number) => contours.pick(number === state ? path : null));
    const place = path === null ? undefined : this.contours[state]?.places[path];
    if (place && isSought) this.orbit.lookAt(place.place, place.radius);
    this.draw();
  }

  /** Looks at a vertex of a state. */
  lookAtVertex(state: number, vertex: number) {
    this.orbit.lookAt(placeOf(this.states[state]!, vertex), null);
  }

  draw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => this.render());
  }

  /** Draws at once. */
  render() {
    this.isAsked = false;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (width === 0 || height === 0 || !this.isSized) return;
    const ratio = this.renderer.getPixelRatio();
    const sight = {
      width,
      height,
      ratio,
      pixelsPerMetre: this.orbit.pixelsPerMetre(height),
      near: this.orbit.camera.near,
    };
    const shares = this.shares();
    this.contours.forEach((contours, i) => contours.prepare(shares[i]!, sight));
    this.dots.forEach((dots, i) =>
      dots.forEach((points) => {
        const material = points.material as PointsMaterial;
        points.visible = shares[i]! > 0.5;
        material.size = (material.userData as { size: number }).size * ratio;
      }),
    );
    this.renderer.render(this.scene, this.orbit.camera);
  }

  /** How much of the paths of each state shows: none half way between two states. */
  private shares(): number[] {
    if (this.contours.length < 2) return [1];
    const fade = (distance: number) => Math.max(0, 1 - 2 * distance);
    return [fade(this.mixing), fade(1 - this.mixing)];
  }

  private resize() {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    this.isSized = true;
    this.orbit.resize(width, height);
    this.render();
  }

  /** The path at a pixel, else the vertex of the cloth. */
  private find(x: number, y: number): Picked {
    const state = this.mixing > 0.5 ? this.states.length - 1 : 0;
    const project = (place: Vector3): [number, number, number] => {
      place.project(this.orbit.camera);
      return [((place.x + 1) / 2) * this.canvas.clientWidth, ((1 - place.y) / 2) * this.canvas.clientHeight, place.z];
    };
    const own = this.states[state]!;
    let [path, nearest]: [number | null, number] = [null, 9];
    const place = new Vector3();
    for (const line of own.lines) {
      if (!this.contours[state]!.isShown(line.path)) continue;
      for (let i = line.first; i < line.first + line.count; i++) {
        const [px, py] = project(place.fromArray(own.points, 3 * i));
        const distance = Math.hypot(px - x, py - y);
        if (distance < nearest) [path, nearest] = [line.path, distance];
      }
    }
    if (path !== null) return { path, vertex: null };
    let [vertex, depth]: [number | null, number] = [null, Infinity];
    const [first, last] = [this.states[0]!.positions, this.states[this.states.length - 1]!.positions];
    const end = new Vector3();
    for (let i = 0; i < first.length / 3; i++) {
      place.fromArray(first, 3 * i).lerp(end.fromArray(last, 3 * i), this.mixing);
      const [px, py, pz] = project(place);
      if (Math.hypot(px - x, py - y) < 10 && pz < depth) [vertex, depth] = [i, pz];
    }
    return { path: null, vertex };
  }
}

function discTexture(): CanvasTexture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 32;
  const g = canvas.getContext("2d")!;
  g.fillStyle = "#ffffff";
  g.arc(16, 16, 15, 0, 2 * Math.PI);
  g.fill();
  return new CanvasTexture(canvas);
}

function placeOf(state: State, vertex: number): Vector3 {
  return new Vector3().fromArray(state.positions, 3 * vertex);
}

function boxOf(states: State[]): { centre: Vector3; size: Vector3 } {
  const [low, high] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
  const place = new Vector3();
  for (const { positions } of states) {
    for (let i = 0; i < positions.length; i += 3) {
      place.fromArray(positions, i);
      low.min(place);
      high.max(place);
    }
  }
  const size = high.clone().sub(low);
  return { centre: low.clone().add(high).multiplyScalar(0.5), size };
}
