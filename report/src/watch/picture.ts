// The picture of one session, with what belongs to it.
import { viewControls } from "../controls";
import { counted, digits, el, metres } from "../dom";
import { surfaceOfRoles } from "../surface";
import { View } from "../view";
import { Arrows } from "./arrows";
import type { FrameMessage, MeshMessage } from "./message";
import { shownOf } from "./shown";

/** Milliseconds a frame above which a live picture gets coarser, and below which it gets finer again. */
const SLOW_MS = 50;
const FAST_MS = 28;
const COARSENESSES = [1, 1.4, 2];
/** Least time from picture to picture where processors draw: the session wants them, too. */
const SOFTWARE_MS = 60;
/** Points of paths that are so near are one in live pictures there. */
const LEAST_PIXELS = 2;

/** What somebody does in the picture. */
export interface Acts {
  pick: (path: number | null) => void;
  /** To the path before or after. */
  beside: (step: number) => void;
  pause: () => void;
  step: (by: number) => void;
}

export class Picture {
  readonly element: HTMLElement;
  readonly controls: HTMLElement;
  readonly view: View;
  private readonly arrows: Arrows;
  private readonly arrowWords = el("span", {});
  /** Least time from one live picture to the next, in milliseconds. */
  readonly leastMs: number;
  /** Where a live picture begins: in software with the coarsest, which may get finer. */
  private readonly firstCoarseness: number;
  private coarseness: number;
  private busyMs = 0;

  constructor(mesh: MeshMessage, first: FrameMessage, acts: Acts) {
    const surface = surfaceOfRoles(mesh.roles, mesh.triangles, mesh.numClothFaces, first.positions);
    this.view = new View(surface, [shownOf(first, 0)], ({ path }) => acts.pick(path), true);
    const { canvas, isSoftware } = this.view;
    this.arrows = new Arrows(this.view.radius, isSoftware);
    this.view.add(this.arrows);
    this.leastMs = isSoftware ? SOFTWARE_MS : 0;
    this.firstCoarseness = isSoftware ? COARSENESSES.length - 1 : 0;
    this.coarseness = this.firstCoarseness;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "The cloth and its intersection paths");
    canvas.setAttribute("aria-describedby", "keys");
    canvas.addEventListener("keydown", (event) => this.key(event, acts));
    const box = el("input", { type: "checkbox", id: "arrows", change: () => this.setArrows(box.checked) });
    box.checked = true;
    this.element = el("div", { class: "frame" }, canvas);
    this.controls = el(
      "div",
      {},
      viewControls(this.view, acts.beside, true),
      el("label", { class: "plain arrows" }, box, "corrections as arrows: ", this.arrowWords),
    );
  }

  private key(event: KeyboardEvent, acts: Acts) {
    const actions: Record<string, () => void> = {
      n: () => acts.beside(1),
      p: () => acts.beside(-1),
      ".": () => acts.step(1),
      ",": () => acts.step(-1),
      " ": acts.pause,
      Escape: () => acts.pick(null),
    };
    const action = actions[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  }

  private setArrows(isShown: boolean) {
    this.arrows.object.visible = isShown;
    this.view.draw();
  }

  private sayArrows({ corrected, unit }: FrameMessage, largest: number) {
    const size = unit === "m" ? metres(largest) : `${digits(largest)} ${unit}`;
    const step = this.arrows.step(corrected.length);
    const some = step > 1 ? `, one in ${step} drawn` : "";
    const words = `${counted(corrected.length, "correction")}, the largest ${size}${some}`;
    this.arrowWords.textContent = largest === 0 ? "no corrections" : words;
  }

  /** Resolves when it is drawn. `isLive`: as coarse as live pictures are; `isSaid`: words follow as well. */
  show(frame: FrameMessage, picked: number | null, isLive: boolean, isSaid: boolean): Promise<void> {
    const largest = this.arrows.show(frame);
    if (isSaid) this.sayArrows(frame, largest);
    const apart = isLive && this.view.isSoftware ? LEAST_PIXELS * this.view.metresPerPixel : 0;
    this.view.setStates([shownOf(frame, apart)]);
    if (picked !== null) this.view.pickPath(0, picked, false);
    // `setStates` has asked for a picture in the next frame of the screen; the one after that comes when it is drawn.
    return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done())));
  }

  /** Draws coarser while pictures take long, and as fine as it can while it stands still. */
  adapt(tookMs: number, isLive: boolean) {
    if (!isLive) {
      this.coarseness = this.firstCoarseness;
      this.busyMs = 0;
      this.view.setCoarseness(1);
    } else {
      this.busyMs = this.busyMs === 0 ? tookMs : 0.8 * this.busyMs + 0.2 * tookMs;
      const step = this.busyMs > SLOW_MS ? 1 : this.busyMs < FAST_MS ? -1 : 0;
      const next = Math.max(0, Math.min(COARSENESSES.length - 1, this.coarseness + step));
      // What the next fineness takes shows in some frames only.
      if (next !== this.coarseness) this.busyMs = 0;
      this.coarseness = next;
      this.view.setCoarseness(COARSENESSES[next]!);
    }
  }

  dispose() {
    this.view.dispose();
  }
}
