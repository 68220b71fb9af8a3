// The camera: turns round a point, by pointer, wheel, touch and keys.
import { PerspectiveCamera, Vector3 } from "three";

export type Up = "x" | "y" | "z";

const UPS: Record<Up, [Vector3, Vector3, Vector3]> = {
  // Up, towards a viewer in front, right.
  y: [new Vector3(0, 1, 0), new Vector3(0, 0, 1), new Vector3(1, 0, 0)],
  z: [new Vector3(0, 0, 1), new Vector3(0, -1, 0), new Vector3(1, 0, 0)],
  x: [new Vector3(1, 0, 0), new Vector3(0, 0, 1), new Vector3(0, 1, 0)],
};

/** The height of a box: y, unless it lies flat. */
export function likelyUp(size: Vector3): Up {
  const axes: [Up, number][] = [
    ["y", size.y],
    ["z", size.z],
    ["x", size.x],
  ];
  axes.sort((a, b) => a[1] - b[1]);
  const [least, next] = [axes[0]!, axes[1]!];
  return least[1] < 0.45 * next[1] && least[0] !== "x" ? least[0] : "y";
}

export class OrbitCamera {
  readonly camera = new PerspectiveCamera(30, 1, 0.01, 100);
  readonly target = new Vector3();
  private azimuth = 0.6;
  private elevation = 0.45;
  private distance = 1;
  private up: Up = "y";
  /** Whether the whole box is in sight, and nobody has changed that. */
  private isFitted = false;
  private centre = new Vector3();
  private half = new Vector3(1, 1, 1);
  private radius = 1;

  constructor(private readonly changed: () => void) {}

  /** The box that fits into the picture: its centre, and half of its size. */
  frame(centre: Vector3, half: Vector3, up: Up) {
    this.setBox(centre, half);
    this.up = up;
    this.fit();
  }

  /** The box that is shown when the whole is asked for next. */
  setBox(centre: Vector3, half: Vector3) {
    this.centre.copy(centre);
    this.half.copy(half);
    this.radius = Math.max(half.length(), 1e-9);
  }

  setUp(up: Up) {
    this.up = up;
    if (this.isFitted) this.fit();
    this.update();
  }

  fit() {
    this.target.copy(this.centre);
    this.update();
    // How far away each corner of the box is in sight.
    const tangent = Math.tan((this.camera.fov * Math.PI) / 360);
    const [right, up, towards] = [new Vector3(), new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(right, up, towards);
    let distance = this.radius * 0.5;
    for (let corner = 0; corner < 8; corner++) {
      const sign = (bit: number) => ((corner >> bit) & 1 ? 1 : -1);
      const place = new Vector3(sign(0), sign(1), sign(2)).multiply(this.half);
      const across = Math.abs(place.dot(right)) / (tangent * this.camera.aspect);
      distance = Math.max(distance, Math.max(across, Math.abs(place.dot(up)) / tangent) + place.dot(towards));
    }
    this.isFitted = true;
    this.distance = distance * 1.04;
    this.update();
  }

  private fitting(radius: number): number {
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(1, this.camera.aspect);
    return radius / Math.sin(Math.atan(Math.tan(half) * narrow));
  }

  /** Looks at what is within a radius of a place, or at a place with its surroundings. */
  lookAt(place: Vector3, radius: number | null) {
    this.isFitted = false;
    this.target.copy(place);
    const least = radius === null ? this.radius * 0.2 : Math.max(radius * 1.6, this.radius * 0.05);
    this.distance = Math.min(this.fitting(least), this.fitting(this.radius));
    this.update();
  }

  from(azimuth: number, elevation: number) {
    this.azimuth = azimuth;
    this.elevation = elevation;
    if (this.isFitted) this.fit();
    this.update();
  }

  rotate(across: number, upwards: number) {
    this.isFitted = false;
    this.azimuth -= across;
    this.elevation = Math.max(-1.55, Math.min(1.55, this.elevation + upwards));
    this.update();
  }

  zoom(factor: number) {
    this.isFitted = false;
    this.distance = Math.max(this.radius * 1e-3, Math.min(this.radius * 40, this.distance * factor));
    this.update();
  }

  /** Moves what is looked at, in parts of the height of the picture. */
  pan(across: number, upwards: number) {
    this.isFitted = false;
    const height = 2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360);
    const [right, up] = [new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(right, up, new Vector3());
    this.target.addScaledVector(right, -across * height).addScaledVector(up, upwards * height);
    this.update();
  }

  resize(width: number, height: number) {
    const old = this.fitting(this.radius);
    this.camera.aspect = width / Math.max(1, height);
    if (this.isFitted) {
      this.fit();
      return;
    }
    this.distance *= this.fitting(this.radius) / old;
    this.update();
  }

  /** Pixels that a metre takes at the point that is looked at. */
  pixelsPerMetre(height: number): number {
    return height / (2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  private update() {
    const [up, front, right] = UPS[this.up];
    const flat = Math.cos(this.elevation);
    const towards = new Vector3()
      .addScaledVector(front, Math.cos(this.azimuth) * flat)
      .addScaledVector(right, Math.sin(this.azimuth) * flat)
      .addScaledVector(up, Math.sin(this.elevation));
    this.camera.position.copy(this.target).addScaledVector(towards, this.distance);
    this.camera.up.copy(up);
    this.camera.near = Math.max(this.distance - this.radius * 4, this.distance * 0.02);
    this.camera.far = this.distance + this.radius * 6;
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.changed();
  }
}

/** Lets people move a camera on an element. `picked` gets clicks, in pixels from its corner. */
export function steer(element: HTMLElement, camera: OrbitCamera, picked: (x: number, y: number) => void) {
  const pointers = new Map<number, [number, number]>();
  let travelled = 0;
  let spread = 0;
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 1) travelled = 0;
    spread = spreadOf(pointers);
  });
  element.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    travelled += Math.abs(dx) + Math.abs(dy);
    const height = element.clientHeight;
    if (pointers.size > 1) {
      const now = spreadOf(pointers);
      if (spread > 0 && now > 0) camera.zoom(spread / now);
      spread = now;
      camera.pan(dx / height / pointers.size, dy / height / pointers.size);
    } else if (event.shiftKey || (event.buttons & 6) !== 0) {
      camera.pan(dx / height, dy / height);
    } else {
      camera.rotate((dx * 3.5) / height, (dy * 3.5) / height);
    }
  });
  const end = (event: PointerEvent) => {
    if (pointers.delete(event.pointerId) && event.type === "pointerup" && travelled < 5 && pointers.size === 0) {
      const box = element.getBoundingClientRect();
      picked(event.clientX - box.left, event.clientY - box.top);
    }
    spread = spreadOf(pointers);
  };
  element.addEventListener("pointerup", end);
  element.addEventListener("pointercancel", end);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  // The wheel scrolls the page until the picture has the focus.
  element.addEventListener(
    "wheel",
    (event) => {
      if (document.activeElement !== element && !event.ctrlKey) return;
      event.preventDefault();
      camera.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(0.3, Math.abs(event.deltaY) * 0.002)));
    },
    { passive: false },
  );
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const turn: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const step = turn[event.key];
    if (step && event.shiftKey) camera.pan(step[0] * 0.06, -step[1] * 0.06);
    else if (step) camera.rotate(step[0] * 0.12, step[1] * 0.12);
    else if (event.key === "+" || event.key === "=") camera.zoom(0.85);
    else if (event.key === "-") camera.zoom(1 / 0.85);
    else if (event.key === "Home" || event.key === "0") camera.fit();
    else return;
    event.preventDefault();
  });
}

function spreadOf(pointers: Map<number, [number, number]>): number {
  const [a, b] = [...pointers.values()];
  return a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
}
