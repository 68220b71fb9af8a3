// What the picture shows in words: types with their counts, the list of paths, the one that is chosen, numbers.
import { counted, digits, el, metres } from "../dom";
import { DOTS, KINDS, dotSample, kindOf, sample } from "../kinds";
import type { View } from "../view";
import { FLAGS, type FrameMessage, type PathMessage } from "./message";
import { PLOTS } from "./palette";

const MOST_ROWS = 60;
const MARKS = Object.keys(FLAGS) as (keyof typeof FLAGS)[];

/** The types of paths and of marked vertices, each with a box to hide it and how many there are. */
export class Legend {
  readonly element: HTMLElement;
  private readonly counts = new Map<string, HTMLElement>();
  private readonly rows = new Map<string, HTMLElement>();

  constructor(view: () => View | null) {
    const row = (name: string, picture: HTMLElement, title: string, words: string) => {
      const box = el("input", { type: "checkbox", change: () => view()?.setKind(name, box.checked) });
      box.checked = true;
      const count = el("span", {});
      this.counts.set(name, count);
      const label = el(
        "label",
        { class: "kind", "data-kind": name, hidden: true },
        box,
        picture,
        el("span", { class: "words" }, el("strong", {}, title), " ", count, el("small", {}, words)),
      );
      this.rows.set(name, label);
      return label;
    };
    this.element = el(
      "fieldset",
      { class: "legend" },
      el("legend", {}, "Types of paths, and marked vertices"),
      ...KINDS.map((kind) => row(kind.name, sample(kind), kind.name, kind.words)),
      ...MARKS.map((name) => row(name, dotSample(name), name, DOTS[name].words)),
    );
  }

  /** What has been there once stays in the legend. */
  show(frame: FrameMessage) {
    const counts = new Map<string, number>();
    const add = (name: string) => counts.set(name, (counts.get(name) ?? 0) + 1);
    for (const path of frame.paths) add(path.pair_type);
    for (const flags of frame.flags) {
      if (flags !== 0) MARKS.filter((name) => (flags & FLAGS[name]) !== 0).forEach(add);
    }
    for (const [name, element] of this.counts) {
      const count = counts.get(name) ?? 0;
      element.textContent = count.toLocaleString("en");
      if (count > 0) this.rows.get(name)!.hidden = false;
    }
  }
}

/** The paths of a frame, the longest first. */
export class PathList {
  readonly element = el("section", { class: "lists" });
  /** The frame whose paths these are. */
  frame: FrameMessage | null = null;
  private readonly entries = new Map<number, HTMLButtonElement>();
  private order: number[] = [];
  private picked: number | null = null;

  constructor(private readonly pick: (path: number) => void) {}

  /** Whether somebody is in it, who would lose the place. */
  get isInUse(): boolean {
    return this.element.contains(document.activeElement) || this.element.matches(":hover");
  }

  show(frame: FrameMessage, picked: number | null) {
    this.frame = frame;
    this.picked = picked;
    const { paths } = frame;
    this.order = paths.map((_, path) => path).sort((a, b) => paths[b]!.length_m - paths[a]!.length_m);
    this.entries.clear();
    const rows = this.order.slice(0, MOST_ROWS).map((path) => el("li", {}, this.entry(paths[path]!, path)));
    const more = paths.length - rows.length;
    this.element.replaceChildren(
      el("h3", {}, `Intersection paths of frame ${frame.frame} (${paths.length.toLocaleString("en")})`),
      ...(paths.length === 0 ? [el("p", { class: "none" }, "None: no two faces intersect.")] : []),
      el("ol", { class: "entries" }, ...rows),
      ...(more > 0 ? [el("p", { class: "none" }, `And ${counted(more, "shorter path")}.`)] : []),
    );
  }

  private entry(path: PathMessage, number: number): HTMLButtonElement {
    const reason = path.reason ? el("small", { class: "reason" }, `Blocked: ${path.reason}`) : null;
    const words = el("span", { class: "words" }, el("strong", {}, path.pair_type), ` ${metres(path.length_m)}`, reason);
    const entry = el(
      "button",
      { type: "button", "aria-pressed": String(number === this.picked), click: () => this.pick(number) },
      sample(kindOf(path.pair_type)),
      words,
    );
    this.entries.set(number, entry);
    return entry;
  }

  /** Marks the entry of a path, or none. */
  mark(picked: number | null) {
    this.picked = picked;
    for (const [path, entry] of this.entries) entry.setAttribute("aria-pressed", String(path === picked));
    if (picked !== null) this.entries.get(picked)?.scrollIntoView({ block: "nearest" });
  }

  /** The path that is chosen, in few words. */
  words(): string {
    const path = this.picked === null ? undefined : this.frame?.paths[this.picked];
    return path ? `${path.pair_type}, ${metres(path.length_m)}${path.reason ? `, blocked: ${path.reason}` : ""}` : "";
  }

  /** The path before or after the one that is chosen. */
  beside(step: number): number | null {
    if (this.order.length === 0) return null;
    const at = this.picked === null ? (step > 0 ? -1 : 0) : this.order.indexOf(this.picked);
    return this.order[(at + step + this.order.length) % this.order.length]!;
  }

  /** What is known of the path that is chosen. */
  details(): HTMLElement | null {
    const path = this.picked === null ? undefined : this.frame?.paths[this.picked];
    if (!path) return null;
    const rows: [string, string][] = [
      ["Type", `${path.pair_type}: ${kindOf(path.pair_type).words}`],
      ["Length", metres(path.length_m)],
      ...path.facts,
      ...(path.reason ? [["Blocked", path.reason] as [string, string]] : []),
    ];
    return table("The path that is chosen", rows, "chosen");
  }
}

/** The numbers of a frame. */
export function numbers(frame: FrameMessage): HTMLElement {
  const ms = (microseconds: number | null | undefined) =>
    microseconds === null || microseconds === undefined ? "not known" : `${digits(microseconds / 1000)} ms`;
  const stages = PLOTS.stages.map(({ name, words }): [string, string] => [`Stage: ${words}`, ms(frame.stage_us[name])]);
  return table("Numbers of this frame", [
    ["Frame", String(frame.frame)],
    ["Simulated time", `${digits(frame.simulated_s)} s`],
    ["State", frame.refused ?? "answered"],
    ...PLOTS.counts.map(({ name, words }): [string, string] => [
      words.charAt(0).toUpperCase() + words.slice(1),
      digits(frame.counts[name] ?? 0),
    ]),
    ...(frame.wrong ?? []).map(({ kind, num_vertices, depth_m }): [string, string] => [
      kind === "body" ? "Vertices inside of a body" : "Vertices behind an inner layer",
      `${digits(num_vertices)}${num_vertices > 0 ? `, up to ${metres(depth_m)} deep` : ""}`,
    ]),
    ["Edge-face intersections", digits(frame.counts["num_edge_face_intersections"] ?? 0)],
    ["Frames that newer ones overtook in the daemon", digits(frame.counts["num_skipped_frames"] ?? 0)],
    ["Contour length", metres(frame.contour_length_m)],
    ["Corrections", `${frame.correction}, in ${frame.unit}`],
    ...stages,
    ["All stages", ms(frame.stage_us["total"])],
    ["Age of the correction when it got to this page", ms(frame.latency_us)],
    ["Frames since the one before that nobody here saw", digits(frame.num_dropped)],
  ]);
}

function table(title: string, rows: [string, string][], name = ""): HTMLElement {
  const body = rows.map(([head, value]) => el("tr", {}, el("th", { scope: "row" }, head), el("td", {}, value)));
  return el("section", { class: `table ${name}` }, el("h3", {}, title), el("table", {}, el("tbody", {}, ...body)));
}
