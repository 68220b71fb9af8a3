// The list of paths, and of what is on the wrong side or blocked: each entry jumps to its place.
import { type BlockedData, type End, type PathData, type State } from "./data";
import { counted, el, metres } from "./dom";
import { dotSample, kindOf, sample } from "./kinds";

const FIRST_ROWS = 100;

export interface Jumps {
  path: (state: number, path: number) => void;
  vertex: (state: number, vertex: number) => void;
}

const STATE_WORDS = { check: "Intersection paths", before: "Paths before", after: "Paths that are left" };

/** The lists of all states, and for a path its entry. */
export class Lists {
  readonly element = el("div", { class: "lists" });
  private readonly entries = new Map<string, HTMLButtonElement>();
  private readonly openers: (() => void)[] = [];
  private readonly orders: number[][] = [];
  /** Paths of the last state that are blocked. */
  private readonly paths = new Map<BlockedData, number>();

  constructor(states: State[], blocked: BlockedData[], jumps: Jumps) {
    states.forEach((state, number) => {
      const reasons = state.name === "before" ? new Map<number, BlockedData>() : reasonsOf(state, blocked);
      for (const [path, entry] of reasons) this.paths.set(entry, path);
      this.element.append(this.pathList(state, number, reasons, jumps));
      for (const section of wrongSides(state, number, jumps)) this.element.append(section);
    });
    if (blocked.length > 0)
      this.element.append(
        blockedList(blocked, (entry) => {
          const [state, path] = [states.length - 1, this.paths.get(entry)];
          if (path !== undefined) jumps.path(state, path);
          else jumps.vertex(state, entry.vertex);
        }),
      );
  }

  private pathList(state: State, number: number, reasons: Map<number, BlockedData>, jumps: Jumps): HTMLElement {
    const order = state.paths.map((_, path) => path);
    order.sort((a, b) => state.paths[b]!.length_m - state.paths[a]!.length_m);
    this.orders.push(order);
    const list = el("ol", { class: "entries" });
    const add = (paths: number[]) => {
      for (const path of paths) {
        const data = state.paths[path]!;
        const words = el("span", { class: "words" }, ...pathWords(data, reasons.get(path)?.reason));
        const button = el(
          "button",
          {
            type: "button",
            "aria-pressed": "false",
            click: () => jumps.path(number, path),
          },
          sample(kindOf(data.pair_type)),
          words,
        );
        this.entries.set(`${number}/${path}`, button);
        list.append(el("li", {}, button));
      }
    };
    add(order.slice(0, FIRST_ROWS));
    const rest = order.slice(FIRST_ROWS);
    let more: HTMLElement | null = null;
    if (rest.length > 0) {
      const open = () => {
        if (!more?.isConnected) return;
        add(rest);
        more.remove();
      };
      more = el(
        "button",
        { type: "button", class: "more", click: open },
        `Show ${counted(rest.length, "shorter path")}`,
      );
      this.openers.push(open);
    } else this.openers.push(() => {});
    const title = `${STATE_WORDS[state.name]} (${state.paths.length.toLocaleString("en")})`;
    const none = state.paths.length === 0 && el("p", { class: "none" }, "None: no two faces intersect.");
    return el("section", { class: "paths", "data-state": state.name }, el("h3", {}, title), none, list, more);
  }

  /** Marks the entry of a path, and brings it into sight. */
  mark(state: number, path: number | null) {
    for (const entry of this.entries.values()) entry.setAttribute("aria-pressed", "false");
    if (path === null) return;
    const key = `${state}/${path}`;
    if (!this.entries.has(key)) this.openers[state]?.();
    const entry = this.entries.get(key);
    entry?.setAttribute("aria-pressed", "true");
    entry?.scrollIntoView({ block: "nearest" });
  }

  /** The path before or after one in the list of a state. */
  beside(state: number, path: number | null, step: number): number | null {
    const order = this.orders[state] ?? [];
    if (order.length === 0) return null;
    const at = path === null ? (step > 0 ? -1 : 0) : order.indexOf(path);
    return order[(at + step + order.length) % order.length]!;
  }
}

function pathWords(data: PathData, reason: string | undefined): (HTMLElement | string)[] {
  const inside = data.copies.reduce((sum, copy) => sum + (copy.inside_vertices?.length ?? 0), 0);
  const facts = [
    counted(data.num_segments, "face pair"),
    data.copies.some((copy) => copy.inside_vertices !== null)
      ? `${counted(inside, "vertex", "vertices")} inside`
      : null,
    data.closed ? "closed" : null,
    ...data.ends.map(endWords),
  ].filter((fact) => fact !== null);
  const words: (HTMLElement | string)[] = [
    el("strong", {}, data.pair_type),
    ` ${metres(data.length_m)}`,
    el("small", {}, facts.join("; ")),
  ];
  if (reason) words.push(el("small", { class: "reason" }, `Blocked: ${reason}`));
  return words;
}

function endWords(end: End): string {
  if (end.kind === "loop") return `loop vertex ${end.vertex}`;
  const what = end.kind === "boundary" ? "boundary edge" : "junction at edge";
  return `${what} ${end.edge[0]}–${end.edge[1]} in face ${end.face}`;
}

/** What is blocked, by the path of the last state that has its type and length. */
function reasonsOf(state: State, blocked: BlockedData[]): Map<number, BlockedData> {
  const reasons = new Map<number, BlockedData>();
  for (const entry of blocked) {
    const isOwn = (path: PathData) =>
      path.pair_type === entry.pair_type && Math.abs(path.length_m - entry.length_m) <= 1e-3 * entry.length_m;
    const found = state.paths.findIndex((path, number) => isOwn(path) && !reasons.has(number));
    if (found >= 0) reasons.set(found, entry);
  }
  return reasons;
}

function wrongSides(state: State, number: number, jumps: Jumps): HTMLElement[] {
  return state.wrongSides.map((wrong) => {
    const where = wrong.kind === "body" ? "inside of a body" : "behind an inner layer";
    const when = state.name === "check" ? "" : `, ${state.name}`;
    const clusters = [...wrong.clusters].sort((a, b) => b.depth_m - a.depth_m).slice(0, FIRST_ROWS);
    const entries = clusters.map((cluster) =>
      el(
        "li",
        {},
        el(
          "button",
          {
            type: "button",
            click: () => jumps.vertex(number, cluster.vertex),
          },
          dotSample(wrong.kind),
          el(
            "span",
            { class: "words" },
            el("strong", {}, counted(cluster.num_vertices, "vertex", "vertices")),
            ` up to ${metres(cluster.depth_m)} deep`,
            el("small", {}, `deepest: vertex ${cluster.vertex}`),
          ),
        ),
      ),
    );
    const title = `${counted(wrong.vertices.length, "vertex", "vertices")} ${where}${when}`;
    return el("section", { class: "wrong" }, el("h3", {}, title), el("ol", { class: "entries" }, ...entries));
  });
}

function blockedList(blocked: BlockedData[], jump: (entry: BlockedData) => void): HTMLElement {
  const entries = blocked.slice(0, FIRST_ROWS).map((entry) => {
    const what =
      entry.pair_type ?? counted(entry.num_vertices_inside_body ?? 0, "vertex", "vertices") + " inside of a body";
    const size = entry.pair_type ? metres(entry.length_m) : `up to ${metres(entry.length_m)} deep`;
    const where = `vertex ${entry.vertex_in_file} of ${entry.file}${entry.part ? `, ${entry.part}` : ""}`;
    return el(
      "li",
      {},
      el(
        "button",
        { type: "button", click: () => jump(entry) },
        entry.pair_type ? sample(kindOf(entry.pair_type)) : dotSample("body"),
        el(
          "span",
          { class: "words" },
          el("strong", {}, what),
          ` ${size}`,
          el("small", { class: "reason" }, entry.reason),
          el("small", {}, `at ${where}`),
        ),
      ),
    );
  });
  return el(
    "section",
    { class: "blocked" },
    el("h3", {}, `Blocked, with reasons (${blocked.length})`),
    el("ol", { class: "entries" }, ...entries),
  );
}
