// A page that untangled check --html or untangled fix --html wrote: puts its parts together.
import { type PageData, type State, type WrongData, blockedOf, readPage, readState, singles, whole } from "./data";
import { counted, el, metres } from "./dom";
import { beforeAfterSlider, kindLegend, mapChoice, pageButtons, viewControls } from "./controls";
import { Lists } from "./list";
import { type ColourMap, movedMap, stretchMap } from "./maps";
import { Scrubber, Sequence } from "./sequence";
import { surfaceOfParts } from "./surface";
import { tables } from "./tables";
import { View } from "./view";

function wrongWords({ kind, vertices }: WrongData): string {
  const where = kind === "body" ? "inside of a body" : "behind an inner layer";
  return `${counted(vertices.length, "vertex", "vertices")} ${where}`;
}

function verdict(page: PageData, states: State[]): HTMLElement {
  if (page.sequence) return framesVerdict(page);
  const last = states[states.length - 1]!;
  const left = [
    last.paths.length > 0 ? counted(last.paths.length, "intersection path") : null,
    ...last.wrongSides.map(wrongWords),
  ].filter((words) => words !== null);
  const isClean = page.command === "fix" ? page.report["clean"] === true : left.length === 0;
  const words = isClean
    ? "Clean: nothing intersects"
    : left.length > 0
      ? `Not clean: ${left.join(", ")}`
      : "Not clean: see the summary";
  return el(
    "p",
    { class: isClean ? "verdict clean" : "verdict tangled", role: "status" },
    `${isClean ? "✓" : "✗"} ${words}`,
  );
}

function framesVerdict(page: PageData): HTMLElement {
  const { frames } = page.sequence!;
  const clean = frames.filter(({ line }) => line["clean"] === true).length;
  const isClean = clean === frames.length;
  return el(
    "p",
    { class: isClean ? "verdict clean" : "verdict tangled", role: "status" },
    `${isClean ? "✓" : "✗"} ${clean} of ${counted(frames.length, "frame")} ${clean === 1 ? "is" : "are"} clean`,
  );
}

/** Whose vertex it is, and what became of it. */
function vertexWords(page: PageData, maps: ColourMap[], vertex: number): string {
  let first = 0;
  for (const part of page.mesh.parts) {
    if (vertex < first + part.num_vertices) {
      return [`Vertex ${vertex - first} of ${part.file}`, ...maps.map((map) => map.words(vertex))].join(", ");
    }
    first += part.num_vertices;
  }
  return `Vertex ${vertex}`;
}

/** The colour maps of what was done; of a sequence those of a frame. */
function mapsOf(page: PageData, sequence: Sequence | null, frame: number): ColourMap[] {
  if (page.change) return [movedMap(singles(page.change.moved_m)), stretchMap(singles(page.change.stretch))];
  const stretch = sequence?.stretch(frame);
  return sequence && stretch ? [movedMap(sequence.moved(frame)), stretchMap(stretch)] : [];
}

function picture(page: PageData, first: State[], sequence: Sequence | null): HTMLElement {
  let states = first;
  let maps = mapsOf(page, sequence, 0);
  let picked: { state: number; path: number | null } = { state: 0, path: null };
  let shown = 0;
  const status = el(
    "p",
    { class: "status", role: "status", "aria-live": "polite" },
    "Click a path or a vertex, or choose a path in the list.",
  );
  const pick = (state: number, path: number | null, isSought: boolean) => {
    picked = { state, path };
    view.pickPath(state, path, isSought);
    lists.mark(state, path);
    // On a phone the list is below the picture.
    if (isSought) view.canvas.scrollIntoView({ block: "nearest" });
    const data = path === null ? undefined : states[state]!.paths[path];
    status.textContent = data
      ? `${data.pair_type}, ${metres(data.length_m)}, ${counted(data.num_segments, "face pair")}`
      : "";
  };
  const surface = surfaceOfParts(page.mesh.parts, whole(page.mesh.triangles), states[0]!.positions);
  const view = new View(surface, states, ({ path, vertex }) => {
    pick(shown, path, false);
    if (vertex !== null) status.textContent = vertexWords(page, maps, vertex);
  });
  const slider =
    states.length > 1
      ? beforeAfterSlider((mixing) => {
          shown = mixing > 0.5 ? 1 : 0;
          view.setMixing(mixing);
        })
      : null;
  const makeLists = (frame: number) =>
    new Lists(states, blockedOf(page, frame), {
      path: (state, path) => {
        slider?.set(state);
        pick(state, path, true);
      },
      vertex: (state, vertex) => {
        slider?.set(state);
        pick(state, null, false);
        view.lookAtVertex(state, vertex);
        view.canvas.scrollIntoView({ block: "nearest" });
        status.textContent = vertexWords(page, maps, vertex);
      },
    });
  let lists = makeLists(0);
  const choice = mapChoice(maps, view);
  const scrubber =
    sequence &&
    new Scrubber(sequence, page, (frame, stays) => {
      states = sequence.states(frame);
      view.setStates(states);
      picked = { state: shown, path: null };
      maps = mapsOf(page, sequence, frame);
      choice.renew(maps);
      if (!stays) return;
      const old = lists.element;
      lists = makeLists(frame);
      old.replaceWith(lists.element);
    });
  const step = (by: number) => {
    const path = lists.beside(shown, picked.state === shown ? picked.path : null, by);
    if (path !== null) pick(shown, path, true);
  };
  const { canvas } = view;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-label", "The mesh and its intersection paths");
  canvas.setAttribute("aria-describedby", "keys");
  canvas.addEventListener("keydown", (event) => {
    if (event.key === "n") step(1);
    else if (event.key === "p") step(-1);
    else if (event.key === ".") scrubber?.step(1);
    else if (event.key === ",") scrubber?.step(-1);
    else if (event.key === "Escape") pick(shown, null, false);
  });
  const hasPaths = sequence !== null || states.some((state) => state.paths.length > 0);
  return el(
    "div",
    { class: "main" },
    el(
      "div",
      { class: "picture" },
      el("div", { class: "frame" }, canvas),
      still(view),
      status,
      el("div", { class: "noprint controls" }, scrubber?.element, slider?.element, viewControls(view, step, hasPaths)),
      choice.element,
      kindLegend(page, states, view),
      keysHint(sequence !== null),
    ),
    lists.element,
  );
}

/** The picture that is printed. */
function still(view: View): HTMLElement {
  const image = el("img", { class: "still", alt: "The mesh as it was shown last" });
  const keep = () => {
    view.render();
    image.src = view.canvas.toDataURL("image/png");
  };
  window.addEventListener("beforeprint", keep);
  return image;
}

function keysHint(hasFrames: boolean): HTMLElement {
  const frames = hasFrames ? ", comma and full stop to the frame before and after" : "";
  return el(
    "p",
    { id: "keys", class: "noprint hint" },
    "With the picture focused: arrow keys turn it, with Shift they move it, + and − bring it nearer and farther, " +
      `Home shows all of it, N and P go to the next and the previous path${frames}. ` +
      "A pointer turns it, with Shift or the right button moves it; the wheel zooms once the picture has the focus.",
  );
}

function withoutPicture(error: unknown): HTMLElement {
  const words = error instanceof Error ? error.message : String(error);
  return el("p", { class: "verdict tangled" }, `This browser shows no picture (${words}); all numbers are below.`);
}

async function main() {
  const page = readPage();
  const sequence = page.sequence ? await Sequence.read(page) : null;
  const states = page.states.map((data) => readState(page, data));
  const root = document.getElementById("page")!;
  const files = page.mesh.parts.map((part) => part.file).join(", ");
  root.append(
    el("header", {}, el("h1", {}, `untangled ${page.command}`), el("p", { class: "files" }, files), pageButtons(page)),
    verdict(page, states),
  );
  const main = el("main");
  root.append(main);
  try {
    main.append(picture(page, states, sequence));
  } catch (error) {
    main.append(
      withoutPicture(error),
      new Lists(states, blockedOf(page, 0), { path: () => {}, vertex: () => {} }).element,
    );
  }
  main.append(
    el("h2", {}, "Summary"),
    el("pre", { class: "scroll", tabindex: 0 }, page.summary),
    el("h2", {}, "Numbers"),
    el("div", { class: "tables" }, ...tables(page)),
  );
  root.append(el("footer", {}, `Made by untangled ${page.version}. This file fetches nothing and sends nothing.`));
  document.documentElement.dataset["ready"] = "yes";
}

void main();
