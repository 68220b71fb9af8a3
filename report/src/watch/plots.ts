// Numbers over the last minute, as plots with their numbers in words.
import uPlot from "uplot";

import { digits, el } from "../dom";
import { DASHES, lineSample } from "../kinds";
import type { FrameMessage } from "./message";
import { PLOTS, type PlotLine } from "./palette";

const SECONDS = 60;
const HEIGHT = 110;
/** Plots and words follow so many times a second: people read no faster. */
const REDRAW_MS = 500;

type PlotName = keyof typeof PLOTS;

const TITLES: Record<PlotName, string> = {
  counts: "Counts",
  contour: "Contour length in metres",
  stages: "Time of each stage in milliseconds",
  latency: "Times of a frame in milliseconds",
};

/** The numbers of a plot's lines. */
const VALUES: Record<PlotName, (frame: FrameMessage, name: string) => number | null> = {
  counts: (frame, name) => frame.counts[name] ?? null,
  contour: (frame) => frame.contour_length_m,
  stages: (frame, name) => (frame.stage_us[name] ?? 0) / 1000,
  latency: (frame, name) => {
    const microseconds = name === "latency" ? frame.latency_us : (frame.stage_us["total"] ?? null);
    return microseconds === null ? null : microseconds / 1000;
  },
};

/** All plots, over the same time. */
export class Plots {
  readonly element: HTMLElement;
  private readonly plots: Plot[];
  private times: number[] = [];
  private marked: number | null = null;
  private drawnAt = 0;

  /** `seek` gets the time of a click, in milliseconds of the page. */
  constructor(seek: (at: number) => void) {
    this.plots = (Object.keys(PLOTS) as PlotName[]).map((name) => new Plot(name, () => this.marked, seek));
    const title = el("h3", {}, `The last ${SECONDS} seconds`);
    this.element = el("section", { class: "plots" }, title, ...this.plots.map(({ element }) => element));
  }

  add(frame: FrameMessage) {
    const last = this.times.at(-1);
    // A pause is a gap.
    if (last !== undefined && frame.at / 1000 - last > 3) this.push(last + 0.001, null);
    this.push(frame.at / 1000, frame);
    const num = this.times.findIndex((time) => time >= frame.at / 1000 - SECONDS);
    this.times.splice(0, num);
    for (const plot of this.plots) plot.drop(num);
    if (performance.now() - this.drawnAt > REDRAW_MS) this.redraw();
  }

  private push(time: number, frame: FrameMessage | null) {
    this.times.push(time);
    for (const plot of this.plots) plot.push(frame);
  }

  /** Marks the time of the frame that is shown; nothing while that is the newest. */
  mark(frame: FrameMessage | null) {
    this.marked = frame ? frame.at / 1000 : null;
    this.redraw();
  }

  redraw() {
    this.drawnAt = performance.now();
    for (const plot of this.plots) plot.redraw(this.times, this.marked);
  }

  clear() {
    for (const plot of this.plots) plot.drop(this.times.length);
    this.times = [];
  }
}

class Plot {
  readonly element: HTMLElement;
  private readonly lines: PlotLine[];
  private readonly values: (number | null)[][];
  private readonly words: HTMLElement[];
  private readonly plot: uPlot;
  private newest = 0;

  constructor(
    private readonly name: PlotName,
    marked: () => number | null,
    seek: (at: number) => void,
  ) {
    this.lines = PLOTS[name];
    this.values = this.lines.map(() => []);
    this.words = this.lines.map(() => el("span", {}));
    const entries = this.lines.map((line, k) =>
      el(
        "li",
        {},
        lineSample(`${name} ${line.name}`, line),
        el("span", { class: "words" }, `${line.words} `, this.words[k]!),
      ),
    );
    const field = el("div", { class: "plot", role: "img", "aria-label": `${TITLES[name]}: numbers below` });
    const caption = el("figcaption", {}, TITLES[name]);
    this.element = el("figure", {}, caption, field, el("ul", { class: "lines" }, ...entries));
    this.plot = new uPlot(this.options(marked), [[], ...this.values] as uPlot.AlignedData, field);
    this.plot.over.addEventListener("click", (event) => seek(1000 * this.plot.posToVal(event.offsetX, "x")));
    new ResizeObserver(() => {
      if (field.clientWidth > 0) this.plot.setSize({ width: field.clientWidth, height: HEIGHT });
    }).observe(field);
  }

  private options(marked: () => number | null): uPlot.Options {
    // On paper, in light and in dark: lines have the same colours in both.
    const axis = {
      stroke: "#333333",
      grid: { stroke: "#d8d2c4", width: 1 },
      ticks: { show: false },
      font: "11px sans-serif",
    };
    const line = (plot: uPlot) => {
      const at = marked();
      if (at === null) return;
      const { ctx, bbox } = plot;
      const x = Math.round(plot.valToPos(at, "x", true));
      ctx.fillStyle = "#1d2026";
      ctx.fillRect(x - 1, bbox.top, 2, bbox.height);
    };
    const ago = [0, -15, -30, -45, -60];
    return {
      width: 300,
      height: HEIGHT,
      legend: { show: false },
      cursor: { show: false },
      hooks: { draw: [line] },
      scales: {
        x: { time: false, range: () => [this.newest - SECONDS, this.newest] },
        y: { range: (_, __, most) => [0, most > 0 ? 1.08 * most : 1] },
      },
      axes: [
        {
          ...axis,
          size: 22,
          splits: () => ago.map((seconds) => this.newest + seconds).reverse(),
          values: (_, splits) => splits.map((at) => `${Math.round(at - this.newest)} s`),
        },
        { ...axis, size: 48, space: 28, values: (_, splits) => splits.map((value) => digits(value)) },
      ],
      series: [
        {},
        ...this.lines.map((line) => ({
          stroke: line.colour,
          width: 1.6,
          dash: (DASHES[line.dash] ?? []).map((length) => length / 1.5),
          points: { show: false },
        })),
      ],
    };
  }

  push(frame: FrameMessage | null) {
    this.lines.forEach((line, k) => this.values[k]!.push(frame ? VALUES[this.name](frame, line.name) : null));
  }

  drop(num: number) {
    for (const values of this.values) values.splice(0, num);
  }

  /** Draws, and says the numbers at the marked time, else the newest. */
  redraw(times: number[], marked: number | null) {
    this.newest = times.at(-1) ?? 0;
    this.plot.setData([times, ...this.values] as uPlot.AlignedData);
    const found = marked === null ? times.length - 1 : times.findIndex((time) => time >= marked);
    this.words.forEach((words, k) => {
      const values = this.values[k]!;
      const known = values.filter((value) => value !== null);
      const own = values[found];
      words.textContent =
        own === null || own === undefined
          ? "–"
          : `${digits(own)} (from ${digits(Math.min(...known))} to ${digits(Math.max(...known))})`;
    });
  }
}
