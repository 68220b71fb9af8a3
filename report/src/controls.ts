// The controls under the picture, and the legends.
import type { FoundData, PageData, State } from "./data";
import { counted, el } from "./dom";
import { DOTS, type DotName, KINDS, dotSample, sample } from "./kinds";
import { type ColourMap, gradientOf } from "./maps";
import type { Up } from "./camera";
import type { View } from "./view";

/** A slider between the two states, with buttons for its ends. */
export function beforeAfterSlider(moved: (mixing: number) => void): {
  element: HTMLElement;
  set: (mixing: number) => void;
} {
  const words = (mixing: number) =>
    mixing === 0 ? "before" : mixing === 1 ? "after" : `${Math.round(mixing * 100)} % of the way`;
  const output = el("output", { for: "slider" }, "before");
  const slider = el("input", {
    type: "range",
    id: "slider",
    min: 0,
    max: 100,
    value: 0,
    "aria-valuetext": "before",
    input: () => set(Number(slider.value) / 100),
  });
  const set = (mixing: number) => {
    slider.value = String(Math.round(mixing * 100));
    slider.setAttribute("aria-valuetext", words(mixing));
    output.textContent = words(mixing);
    moved(mixing);
  };
  const end = (mixing: number, text: string) => el("button", { type: "button", click: () => set(mixing) }, text);
  const element = el(
    "div",
    { class: "row slider" },
    el("label", { for: "slider" }, "Before and after"),
    end(0, "Before"),
    slider,
    end(1, "After"),
    output,
  );
  return { element, set };
}

/** What colours the cloth: nothing, or a colour map with its legend. `renew` gives it the maps of another frame. */
export function mapChoice(
  first: ColourMap[],
  view: View,
): { element: HTMLElement; renew: (maps: ColourMap[]) => void } {
  let maps = first;
  const legend = el("div", { class: "map", hidden: true });
  const choose = (name: string) => {
    const map = maps.find((map) => map.name === name) ?? null;
    view.setMap(map);
    legend.hidden = map === null;
    legend.replaceChildren(...(map ? mapLegend(map) : []));
  };
  const select = el(
    "select",
    { id: "map", change: () => choose(select.value) },
    el("option", { value: "" }, "files or pieces, inside regions hatched"),
    ...maps.map((map) => el("option", { value: map.name }, map.name === "moved" ? "distance moved" : "stretch")),
  );
  const row =
    maps.length > 0 && el("div", { class: "row noprint" }, el("label", { for: "map" }, "Colour the cloth by"), select);
  const renew = (others: ColourMap[]) => {
    maps = others;
    if (select.value !== "") choose(select.value);
  };
  return { element: el("div", {}, row, legend), renew };
}

function mapLegend(map: ColourMap): HTMLElement[] {
  const bar = el("div", {
    class: "bar",
    role: "img",
    "aria-label": `${map.title}: from ${map.ticks[0]} to ${map.ticks.at(-1)}`,
  });
  bar.style.background = gradientOf(map);
  return [
    el("p", {}, `${map.title}. Dark lines stand at each fifth of the scale.`),
    bar,
    el("div", { class: "ticks" }, ...map.ticks.map((tick) => el("span", {}, tick))),
  ];
}

/** The types that occur, each with its sample, its numbers, and a box to hide it. */
export function kindLegend(page: PageData, states: State[], view: View): HTMLElement {
  // Of a sequence those of all frames.
  const found: FoundData[][] = page.sequence?.frames.map((frame) => frame.states) ?? [
    states.map((state) => ({ paths: state.paths, points: "", lines: "", wrong_sides: state.wrongSides })),
  ];
  const countOf = (number: number, name: string) =>
    found.reduce(
      (sum, frame) => sum + (frame[number]?.paths ?? []).filter((path) => path.pair_type === name).length,
      0,
    );
  const rows = KINDS.flatMap((kind) => {
    const counts = states.map((_, number) => countOf(number, kind.name));
    if (counts.every((count) => count === 0)) return [];
    const box = el("input", { type: "checkbox", checked: true, change: () => view.setKind(kind.name, box.checked) });
    box.checked = true;
    const numbers = counts.length > 1 ? `${counts[0]} before, ${counts[1]} after` : counted(counts[0]!, "path");
    return [
      el(
        "label",
        { class: "kind", "data-kind": kind.name },
        box,
        sample(kind),
        el("span", { class: "words" }, el("strong", {}, kind.name), ` ${numbers}`, el("small", {}, kind.words)),
      ),
    ];
  });
  const dots = new Set(found.flat().flatMap((state) => state.wrong_sides.map(({ kind }): DotName => kind)));
  if (page.mesh.pinned.length > 0) dots.add("pinned");
  for (const name of dots) rows.push(el("label", { class: "kind" }, dotSample(name), DOTS[name].words));
  if (rows.length === 0) return el("div");
  return el(
    "fieldset",
    { class: "legend" },
    el("legend", {}, page.sequence ? "Types of paths, in all frames" : "Types of paths"),
    ...rows,
  );
}

/** The way the picture is looked at. */
export function viewControls(view: View, step: (by: number) => void, hasPaths: boolean): HTMLElement {
  const button = (text: string, title: string, run: () => void) =>
    el("button", { type: "button", title, "aria-label": title, click: run }, text);
  const { orbit } = view;
  const up = el(
    "select",
    { id: "up", change: () => orbit.setUp(up.value as Up) },
    ...(["y", "z", "x"] as const).map((axis) => el("option", { value: axis }, `${axis} is up`)),
  );
  up.value = view.up;
  const through = el("input", { type: "checkbox", change: () => view.setSeeThrough(through.checked) });
  const paths = [button("◀ Path", "Previous path", () => step(-1)), button("Path ▶", "Next path", () => step(1))];
  return el(
    "div",
    { class: "row views" },
    ...(hasPaths ? paths : []),
    button("Whole", "Show the whole mesh", () => orbit.fit()),
    button("+", "Nearer", () => orbit.zoom(0.8)),
    button("−", "Farther", () => orbit.zoom(1.25)),
    button("⟲", "Turn left", () => orbit.rotate(-0.26, 0)),
    button("⟳", "Turn right", () => orbit.rotate(0.26, 0)),
    button("Front", "From the front", () => orbit.from(0, 0)),
    button("Side", "From the side", () => orbit.from(Math.PI / 2, 0)),
    button("Back", "From the back", () => orbit.from(Math.PI, 0)),
    button("Top", "From the top", () => orbit.from(0, 1.55)),
    button("Below", "From below", () => orbit.from(0, -1.55)),
    el("label", { class: "plain", for: "up" }, up),
    el("label", { class: "plain" }, through, "see through the cloth"),
  );
}

/** Light, dark, or as the system has it. */
export function themeChoice(): HTMLSelectElement {
  const theme = el(
    "select",
    {
      "aria-label": "Light or dark",
      change: () => {
        document.documentElement.dataset["theme"] = theme.value;
      },
    },
    ...[
      ["", "light or dark: as the system"],
      ["light", "light"],
      ["dark", "dark"],
    ].map(([value, text]) => el("option", { value: value! }, text!)),
  );
  return theme;
}

/** Light or dark; and the JSON document as a file. */
export function pageButtons(page: PageData): HTMLElement {
  const save = () => {
    const lines = [...(page.sequence?.frames.map(({ line }) => line) ?? []), page.report];
    const url = URL.createObjectURL(
      new Blob([lines.map((line) => `${JSON.stringify(line)}\n`).join("")], { type: "application/json" }),
    );
    el("a", { href: url, download: `untangled-${page.command}.json` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  };
  return el(
    "div",
    { class: "row noprint" },
    themeChoice(),
    el("button", { type: "button", click: save }, "Save the JSON"),
    el("button", { type: "button", click: () => window.print() }, "Print"),
  );
}
