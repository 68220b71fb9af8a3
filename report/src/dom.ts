// Elements of the page, made in short. Text is text: nothing that a file says becomes markup.

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, string | number | boolean | ((event: Event) => void)>;

export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (typeof value === "boolean") element.toggleAttribute(name, value);
    else element.setAttribute(name, String(value));
  }
  element.append(
    ...children.filter((child): child is Node | string => child !== null && child !== undefined && child !== false),
  );
  return element;
}

/** A length in a unit that suits it, or in that of a given length. */
export function metres(value: number, scale = Math.abs(value)): string {
  if (value === 0) return "0 m";
  const [factor, unit] = scale >= 1 ? [1, "m"] : scale >= 1e-3 ? [1e3, "mm"] : scale >= 1e-6 ? [1e6, "µm"] : [0, ""];
  if (factor === 0 || scale >= 1e6) return `${value.toExponential(3)} m`;
  return `${digits(value * factor)} ${unit}`;
}

// One for all: to make one takes longer than what it writes.
const WHOLE = new Intl.NumberFormat("en");
const FOUR = new Intl.NumberFormat("en", { maximumSignificantDigits: 4 });

/** Four digits, without more than a number needs. */
export function digits(value: number): string {
  if (Number.isInteger(value)) return WHOLE.format(value);
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) return value.toExponential(3);
  return FOUR.format(Number(value.toPrecision(4)));
}

export function counted(count: number, one: string, many = `${one}s`): string {
  return `${WHOLE.format(count)} ${count === 1 ? one : many}`;
}
