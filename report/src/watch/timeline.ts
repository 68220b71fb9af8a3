// Pause, and steps back over the last seconds.
import { el } from "../dom";
import type { History } from "./history";

/** Frames a second: all, or fewer for people who are disturbed by motion. */
const PACES: [value: number, words: string][] = [
  [0, "every frame that can be drawn"],
  [5, "5 frames a second"],
  [1, "one frame a second"],
];

export class Timeline {
  readonly element: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly output = el("output", { for: "past" });
  private readonly button: HTMLButtonElement;
  private readonly pace: HTMLSelectElement;
  /** The frame that is looked at; nothing while the newest is. */
  private at: number | null = null;

  /** `changed` hears of a pause and its frame, and of its end. */
  constructor(
    private readonly history: History,
    private readonly changed: (at: number | null) => void,
  ) {
    const step = (by: number, text: string, title: string) =>
      el("button", { type: "button", title, "aria-label": title, click: () => this.step(by) }, text);
    this.button = el("button", { type: "button", class: "pause", click: () => this.toggle() }, "❚❚ Pause");
    this.slider = el("input", {
      type: "range",
      id: "past",
      min: 0,
      max: 0,
      value: 0,
      input: () => this.pause(Number(this.slider.value)),
    });
    const isCalm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.pace = el("select", { id: "pace" }, ...PACES.map(([value, words]) => el("option", { value }, words)));
    this.pace.value = isCalm ? "1" : "0";
    this.element = el(
      "div",
      { class: "row slider" },
      this.button,
      step(-1, "−1", "Frame before"),
      el("label", { for: "past" }, "The last seconds"),
      this.slider,
      step(1, "+1", "Frame after"),
      this.output,
      el("label", { class: "plain", for: "pace" }, "Show ", this.pace),
    );
  }

  get isPaused(): boolean {
    return this.at !== null;
  }

  /** Shortest time between two frames in milliseconds. */
  get leastMs(): number {
    const pace = Number(this.pace.value);
    return pace > 0 ? 1000 / pace : 0;
  }

  toggle() {
    if (this.at !== null) this.resume();
    else this.pause(this.history.length - 1);
  }

  step(by: number) {
    this.pause((this.at ?? this.history.length - 1) + by);
  }

  /** Stands still at a frame of the history. */
  pause(at: number) {
    if (this.history.length === 0) return;
    this.at = Math.max(0, Math.min(this.history.length - 1, at));
    this.button.textContent = "▶ Go on";
    this.say();
    this.changed(this.at);
  }

  resume() {
    this.at = null;
    this.button.textContent = "❚❚ Pause";
    this.say();
    this.changed(null);
  }

  /** Says where it is; the history may have changed. */
  say() {
    const last = Math.max(0, this.history.length - 1);
    this.slider.max = String(last);
    this.slider.value = String(this.at ?? last);
    const [frame, newest] = [this.history.at(this.at ?? last), this.history.at(last)];
    const ago = frame && newest ? (newest.at - frame.at) / 1000 : 0;
    const words = !frame
      ? "no frames yet"
      : this.at === null
        ? `live, frame ${frame.frame}`
        : `frame ${frame.frame}, ${ago.toFixed(1)} s back`;
    this.output.textContent = words;
    this.slider.setAttribute("aria-valuetext", words);
  }
}
