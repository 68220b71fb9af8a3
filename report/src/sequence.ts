// The frames of a shot: positions are unpacked once, states are made as they are looked at.
import { type PageData, type State, bytes, stateOf } from "./data";
import { el } from "./dom";

/** Frames in a second, as films have them. */
const RATE = 24;
/** Steps of the natural logarithm of a stretch. */
const STRETCH_STEP = 0.0005;

export class Sequence {
  readonly numFrames: number;
  private readonly streams: Uint16Array[];

  private constructor(
    private readonly page: PageData,
    streams: Uint16Array[],
    private readonly stretches: Int16Array | null,
  ) {
    this.numFrames = page.sequence!.frames.length;
    this.streams = streams;
  }

  static async read(page: PageData): Promise<Sequence> {
    const data = page.sequence!;
    const size = 3 * page.mesh.num_vertices;
    const before = await unpack(data.before);
    for (let i = size; i < before.length; i++) before[i] = (before[i]! + before[i - size]!) & 0xffff;
    if (data.after === undefined) return new Sequence(page, [before], null);
    const after = await unpack(data.after);
    for (let i = 0; i < after.length; i++) after[i] = (after[i]! + before[i]!) & 0xffff;
    const stretches = data.stretch === undefined ? null : new Int16Array((await unpack(data.stretch)).buffer);
    return new Sequence(page, [before, after], stretches);
  }

  /** The number that a frame has in the shot. */
  nameOf(frame: number): number {
    return this.page.sequence!.frames[frame]!.frame;
  }

  states(frame: number): State[] {
    const { frames } = this.page.sequence!;
    return this.page.states.map(({ name }, number) =>
      stateOf(this.page, name, this.positions(frame, number), frames[frame]!.states[number]!),
    );
  }

  private positions(frame: number, stream: number): Float32Array {
    const { low, step } = this.page.sequence!;
    const size = 3 * this.page.mesh.num_vertices;
    const own = this.streams[stream]!.subarray(frame * size, (frame + 1) * size);
    const result = new Float32Array(size);
    for (let i = 0; i < size; i++) result[i] = low[i % 3]! + step[i % 3]! * own[i]!;
    return result;
  }

  /** The stretch of the worst edge of each vertex in a frame, as a ratio; nothing where nothing was repaired. */
  stretch(frame: number): Float32Array | null {
    const size = this.page.mesh.num_vertices;
    const own = this.stretches?.subarray(frame * size, (frame + 1) * size);
    return own ? Float32Array.from(own, (steps) => Math.exp(STRETCH_STEP * steps)) : null;
  }

  /** How far each vertex moved in a frame, in metres. */
  moved(frame: number): Float32Array {
    const [before, after] = [this.positions(frame, 0), this.positions(frame, this.streams.length - 1)];
    const result = new Float32Array(before.length / 3);
    for (let i = 0; i < result.length; i++) {
      const at = (k: number) => after[3 * i + k]! - before[3 * i + k]!;
      result[i] = Math.hypot(at(0), at(1), at(2));
    }
    return result;
  }
}

/** The numbers of a stream. */
async function unpack(text: string): Promise<Uint16Array> {
  const packed = new Blob([bytes(text) as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(packed).arrayBuffer());
  const count = planes.length / 2;
  const result = new Uint16Array(count);
  for (let i = 0; i < count; i++) result[i] = planes[i]! | (planes[count + i]! << 8);
  return result;
}

/** Goes through the frames: a scrubber, steps, and play. `shown` hears of a frame, and whether it stays. */
export class Scrubber {
  readonly element: HTMLElement;
  private frame = 0;
  private playing = 0;
  private readonly slider: HTMLInputElement;
  private readonly output = el("output", { for: "frame" });
  private readonly play: HTMLButtonElement;

  constructor(
    private readonly sequence: Sequence,
    page: PageData,
    private readonly shown: (frame: number, stays: boolean) => void,
  ) {
    const last = sequence.numFrames - 1;
    this.slider = el("input", {
      type: "range",
      id: "frame",
      min: 0,
      max: last,
      value: 0,
      input: () => {
        this.stop();
        this.go(Number(this.slider.value));
      },
    });
    this.play = el("button", { type: "button", click: () => (this.playing ? this.stop() : this.start()) }, "▶ Play");
    const step = (by: number, text: string, title: string) =>
      el("button", { type: "button", title, "aria-label": title, click: () => this.step(by) }, text);
    this.element = el(
      "div",
      {},
      el(
        "div",
        { class: "row slider" },
        el("label", { for: "frame" }, "Frame"),
        step(-1, "−1", "Previous frame"),
        this.slider,
        step(1, "+1", "Next frame"),
        this.play,
        this.output,
      ),
      chart(page, (frame) => {
        this.stop();
        this.go(frame);
      }),
    );
    this.say();
  }

  step(by: number) {
    this.stop();
    this.go(Math.max(0, Math.min(this.sequence.numFrames - 1, this.frame + by)));
  }

  private go(frame: number, stays = true) {
    this.frame = frame;
    this.slider.value = String(frame);
    this.say();
    this.shown(frame, stays);
  }

  private say() {
    const words = `frame ${this.sequence.nameOf(this.frame)}`;
    this.output.textContent = words;
    this.slider.setAttribute("aria-valuetext", words);
  }

  private start() {
    this.play.textContent = "❚❚ Pause";
    const [begin, from] = [performance.now(), this.frame];
    const tick = (now: number) => {
      const frame = (from + Math.floor(((now - begin) / 1000) * RATE)) % this.sequence.numFrames;
      if (frame !== this.frame) this.go(frame, false);
      this.playing = requestAnimationFrame(tick);
    };
    this.playing = requestAnimationFrame(tick);
  }

  private stop() {
    if (!this.playing) return;
    cancelAnimationFrame(this.playing);
    this.playing = 0;
    this.play.textContent = "▶ Play";
    this.go(this.frame);
  }
}

/** Intersecting face pairs frame by frame, before and after; a click goes to a frame. */
function chart(page: PageData, go: (frame: number) => void): HTMLElement {
  const { frames } = page.sequence!;
  const counts = (name: string) =>
    frames.map(({ line }) => {
      const own = line[name];
      return typeof own === "object" && own !== null && !Array.isArray(own) ? Number(own["num_face_pairs"] ?? 0) : 0;
    });
  const [before, after] = [counts("before"), counts("after")];
  const most = Math.max(1, ...before, ...after);
  const canvas = el("canvas", {
    class: "chart",
    width: 1200,
    height: 140,
    role: "img",
    "aria-label": `Intersecting face pairs of each frame: at most ${most}. The table of frames has all numbers.`,
  });
  const g = canvas.getContext("2d")!;
  const width = canvas.width / frames.length;
  frames.forEach((_, frame) => {
    const bar = (count: number, colour: string, part: number) => {
      if (count === 0) return;
      const height = Math.max(3, (count / most) * 120);
      g.fillStyle = colour;
      g.fillRect(frame * width, 140 - height, Math.max(1, width * part), height);
    };
    bar(before[frame]!, "#d9a066", 0.9);
    bar(after[frame]!, "#4a1486", 0.45);
  });
  canvas.addEventListener("click", (event) => {
    const part = (event.clientX - canvas.getBoundingClientRect().left) / canvas.clientWidth;
    go(Math.max(0, Math.min(frames.length - 1, Math.floor(part * frames.length))));
  });
  const words = page.command === "fix" ? "wide: before; narrow and dark: after" : "each frame";
  return el(
    "figure",
    {},
    canvas,
    el(
      "figcaption",
      { class: "hint" },
      `Intersecting face pairs, frame by frame (${words}); the highest bar is ${most.toLocaleString("en")}.`,
    ),
  );
}
