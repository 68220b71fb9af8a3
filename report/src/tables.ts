// The numbers of the JSON report as tables.
import type { Json, JsonObject, PageData } from "./data";
import { el } from "./dom";
import { label, valueWords } from "./words";

/** Shown elsewhere on the page. */
const ELSEWHERE = new Set(["schema", "files", "paths", "face_pairs", "blocked"]);
/** Rows that are shown; the JSON has all. */
const MOST_ROWS = 1000;

export function tables(page: PageData): HTMLElement[] {
  const { report } = page;
  const sections: (HTMLElement | null)[] = [scalars(page.command === "fix" ? "The repair" : "The mesh", report)];
  if (isObject(report["before"]) && isObject(report["after"])) {
    sections.push(beforeAfter(report["before"], report["after"]));
  }
  for (const [name, value] of Object.entries(report)) {
    if (ELSEWHERE.has(name) || name === "before" || name === "after") continue;
    sections.push(...tablesOf(label(name), name, value));
  }
  if (page.sequence)
    sections.push(
      list(
        "Frames",
        page.sequence.frames.map(({ line }) => frameRow(line)),
      ),
    );
  sections.push(settings(page));
  return sections.filter((section) => section !== null);
}

function isObject(value: Json | undefined): value is JsonObject {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function isPlain(value: Json): boolean {
  return (
    typeof value !== "object" ||
    value === null ||
    (Array.isArray(value) && value.every((item) => typeof item !== "object"))
  );
}

/** A list, or an object and what is inside of it. */
function tablesOf(title: string, name: string, value: Json): (HTMLElement | null)[] {
  if (Array.isArray(value)) {
    const rows = value.filter(isObject);
    return rows.length > 0 ? [list(title, rows)] : [];
  }
  if (!isObject(value) || Object.keys(value).length === 0) return [];
  // Times by stage have their unit in the name of the whole.
  const unit = /_us$/.test(name) ? "_us" : "";
  const inner = Object.entries(value).filter(([, item]) => !isPlain(item));
  return [
    scalars(title, value, unit),
    ...inner.flatMap(([name, item]) => tablesOf(`${title}: ${label(name).toLowerCase()}`, name, item)),
  ];
}

function scalars(title: string, object: JsonObject, unit = ""): HTMLElement | null {
  const rows = Object.entries(object).filter(([name, value]) => isPlain(value) && !ELSEWHERE.has(name));
  if (rows.length === 0) return null;
  const body = rows.map(([name, value]) => row(label(name), [valueWords(name + unit, value)]));
  return framed(title, el("table", {}, el("tbody", {}, ...body)));
}

function row(head: string, cells: string[]): HTMLTableRowElement {
  return el("tr", {}, el("th", { scope: "row" }, head), ...cells.map((cell) => el("td", {}, cell)));
}

function headOf(names: string[]): HTMLElement {
  return el("thead", {}, el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name))));
}

/** Two objects of the same fields side by side; fields that are objects become rows of their own. */
function beforeAfter(before: JsonObject, after: JsonObject): HTMLElement {
  const rows: HTMLTableRowElement[] = [];
  const add = (prefix: string, a: JsonObject, b: JsonObject) => {
    for (const name of new Set([...Object.keys(a), ...Object.keys(b)])) {
      const [left, right] = [a[name], b[name]];
      if (isObject(left) || isObject(right)) {
        add(name === "path_pairs" ? "Paths of type " : "", isObject(left) ? left : {}, isObject(right) ? right : {});
      } else if (!Array.isArray(left)) {
        const words = (value: Json | undefined) => valueWords(name, value ?? (prefix === "" ? null : 0));
        rows.push(row(prefix + (prefix === "" ? label(name) : name), [words(left), words(right)]));
      }
    }
  };
  add("", before, after);
  return framed("Before and after", el("table", {}, headOf(["", "Before", "After"]), el("tbody", {}, ...rows)));
}

function list(title: string, items: JsonObject[]): HTMLElement {
  const names = [...new Set(items.flatMap((item) => Object.keys(item)))];
  const shown = items.slice(0, MOST_ROWS);
  const rows = shown.map((item) => {
    const cells = names.map((name) => el("td", {}, valueWords(name, item[name] ?? null)));
    return el("tr", {}, ...cells);
  });
  const more =
    items.length > shown.length && el("p", {}, `The first ${MOST_ROWS} of ${items.length}; the JSON has all.`);
  return framed(title, el("table", {}, headOf(names.map(label)), el("tbody", {}, ...rows)), more || null);
}

/** The numbers of a frame that are looked for first. */
function frameRow(line: JsonObject): JsonObject {
  const pairs = (value: Json | undefined) => (isObject(value) ? (value["num_face_pairs"] ?? null) : null);
  const row: JsonObject = {
    frame: line["frame"] ?? null,
    clean: line["clean"] ?? null,
    "face pairs before": pairs(line["before"]),
  };
  if (isObject(line["after"])) row["face pairs after"] = pairs(line["after"]);
  for (const [name, value] of Object.entries(line)) {
    if (isPlain(value) && !Array.isArray(value) && !(name in row) && name !== "schema") row[name] = value;
  }
  return row;
}

function settings(page: PageData): HTMLElement {
  const rows = [
    row("Made by", [`untangled ${page.version}, untangled ${page.command}`]),
    ...page.mesh.parts.map((part) =>
      row(part.role === "body" ? "Body" : part.role === "layer" ? "Layer" : "File", [
        `${part.file} (${valueWords("", part.num_vertices)} vertices, ${valueWords("", part.num_faces)} triangles)`,
      ]),
    ),
    ...page.settings.map(({ name, value }) => row(name, [value])),
  ];
  return framed("Settings and version", el("table", {}, el("tbody", {}, ...rows)));
}

function framed(title: string, ...content: (HTMLElement | null)[]): HTMLElement {
  const scroll = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": title }, ...content);
  return el("section", { class: "table" }, el("h3", {}, title), scroll);
}
