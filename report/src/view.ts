// The picture: cloth, paths, and marked vertices; drawn when something changes, not all the time.
import { ColorManagement, LinearSRGBColorSpace, type Object3D, Scene, Vector3, WebGLRenderer } from "three";

import { OrbitCamera, type Up, likelyUp, steer } from "./camera";
import { Cloth } from "./cloth";
import { Contours, type Sight } from "./contours";
import type { Shown } from "./data";
import { Dots } from "./dots";
import type { ColourMap } from "./maps";
import type { Surface } from "./surface";

export interface Picked {
  path: number | null;
  vertex: number | null;
}

/** What else is drawn, beside cloth, paths and marked vertices. */
export interface Overlay {
  object: Object3D;
  prepare: (sight: Sight) => void;
}

export class View {
  readonly canvas: HTMLCanvasElement;
  readonly orbit: OrbitCamera;
  readonly up: Up;
  /** Whether processors draw, and no graphics card. */
  readonly isSoftware: boolean;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly cloth: Cloth;
  private readonly overlays: Overlay[] = [];
  private contours: Contours[] = [];
  private dots: Dots[][] = [];
  /** Given back after the next picture: programs of shaders that nobody has are linked again, which takes long. */
  private retired: { dispose: () => void }[] = [];
  private readonly hidden = new Set<string>();
  private mixing = 0;
  private isAsked = false;
  private isSized = false;
  private coarseness = 1;

  /** `isLive`: one that changes all the time, without what costs most in software. */
  constructor(
    surface: Surface,
    private states: Shown[],
    onPick: (picked: Picked) => void,
    isLive = false,
  ) {
    // Colours are those of the legend, to the bit.
    ColorManagement.enabled = false;
    this.renderer = new WebGLRenderer({ antialias: !isLive, alpha: true, preserveDrawingBuffer: !isLive });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setClearColor(0, 0);
    // To ask whether shaders are right waits for them.
    this.renderer.debug.checkShaderErrors = false;
    this.canvas = this.renderer.domElement;
    this.isSoftware = isSoftware(this.renderer.getContext());
    this.orbit = new OrbitCamera(() => this.draw());
    this.cloth = new Cloth(surface, states);
    this.scene.add(this.cloth.mesh);
    this.showFound();
    const { centre, size } = boxOf(states);
    this.up = likelyUp(size);
    this.orbit.frame(centre, size.multiplyScalar(0.5), this.up);
    steer(this.canvas, this.orbit, (x, y) => onPick(this.find(x, y)));
    new ResizeObserver(() => this.resize()).observe(this.canvas);
  }

  /** As many other states of the same mesh. */
  setStates(states: Shown[]) {
    this.states = states;
    this.cloth.setStates(states);
    for (const contours of this.contours) this.scene.remove(contours.group);
    for (const dots of this.dots.flat()) this.scene.remove(dots.points);
    this.retired.push(...this.contours, ...this.dots.flat());
    this.showFound();
    const { centre, size } = boxOf(states);
    this.orbit.setBox(centre, size.multiplyScalar(0.5));
    this.draw();
  }

  private showFound() {
    this.contours = this.states.map((state) => new Contours(state));
    for (const contours of this.contours) {
      this.scene.add(contours.group);
      for (const name of this.hidden) contours.setKind(name, false);
    }
    this.dots = this.states.map((state) =>
      state.marked
        .filter(({ vertices }) => vertices.length > 0)
        .map(({ name, vertices }) => new Dots(name, vertices, state.positions)),
    );
    for (const dots of this.dots.flat()) this.scene.add(dots.points);
  }

  add(overlay: Overlay) {
    this.overlays.push(overlay);
    this.scene.add(overlay.object);
  }

  /** Metres that a pixel takes that is drawn, at the point that is looked at. */
  get metresPerPixel(): number {
    return 1 / this.orbit.pixelsPerMetre(this.canvas.height);
  }

  /** Pixels of the page to one that is drawn; 1 unless a picture takes too long. */
  setCoarseness(coarseness: number) {
    if (coarseness === this.coarseness) return;
    this.coarseness = coarseness;
    this.resize();
  }

  /** Gives back what the graphics card holds. */
  dispose() {
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  /** Half of the diagonal of all that is shown, in metres. */
  get radius(): number {
    return boxOf(this.states).size.length() / 2;
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
    const sight: Sight = {
      width,
      height,
      ratio,
      pixelsPerMetre: this.orbit.pixelsPerMetre(height),
      near: this.orbit.camera.near,
    };
    this.cloth.prepare(this.canvas.width, this.canvas.height);
    const shares = this.shares();
    this.contours.forEach((contours, i) => contours.prepare(shares[i]!, sight));
    const isShown = (own: Dots, state: number) => shares[state]! > 0.5 && !this.hidden.has(own.name);
    this.dots.forEach((dots, i) => dots.forEach((own) => own.prepare(isShown(own, i), ratio)));
    this.overlays.forEach((overlay) => overlay.prepare(sight));
    this.renderer.render(this.scene, this.orbit.camera);
    for (const old of this.retired.splice(0)) old.dispose();
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
    // In one call: each of another size makes all buffers anew.
    this.renderer.setDrawingBufferSize(width, height, Math.min(2, window.devicePixelRatio || 1) / this.coarseness);
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

/** By its name, which takes a while to get. */
function isSoftware(gl: WebGLRenderingContext | WebGL2RenderingContext): boolean {
  const named = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(named?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

function placeOf(state: Shown, vertex: number): Vector3 {
  return new Vector3().fromArray(state.positions, 3 * vertex);
}

function boxOf(states: Shown[]): { centre: Vector3; size: Vector3 } {
  const [low, high] = [new Vector3(), new Vector3()];
  for (let axis = 0; axis < 3; axis++) {
    let [least, most] = [Infinity, -Infinity];
    for (const { positions } of states) {
      for (let i = axis; i < positions.length; i += 3) {
        const value = positions[i]!;
        if (value < least) least = value;
        if (value > most) most = value;
      }
    }
    low.setComponent(axis, least);
    high.setComponent(axis, most);
  }
  const size = high.clone().sub(low);
  return { centre: low.clone().add(high).multiplyScalar(0.5), size };
}
