// Colours of the live page beside those of paths: lines of the plots with their dashes, and arrows.
import type { Stroke } from "../kinds";

export interface PlotLine extends Stroke {
  /** Its name in a frame's numbers. */
  name: string;
  words: string;
}

export const PLOTS: Record<"counts" | "contour" | "stages" | "latency", PlotLine[]> = {
  counts: [
    { name: "num_face_pairs", words: "intersecting face pairs", colour: "#b8480a", dash: "solid" },
    { name: "num_inside", words: "vertices inside", colour: "#0068a8", dash: "long" },
    { name: "num_paths", words: "paths", colour: "#5f1f7a", dash: "dots" },
  ],
  contour: [{ name: "contour_length_m", words: "contour length", colour: "#0068a8", dash: "solid" }],
  stages: [
    { name: "ingest", words: "ingest", colour: "#777777", dash: "solid" },
    { name: "intersect", words: "intersect", colour: "#0068a8", dash: "long" },
    { name: "paths", words: "paths", colour: "#c8460a", dash: "short" },
    { name: "regions", words: "regions", colour: "#007a5a", dash: "dots" },
    { name: "correspond", words: "correspond", colour: "#7b1060", dash: "solid" },
    { name: "respond", words: "respond", colour: "#8a6a00", dash: "long" },
    { name: "publish", words: "publish", colour: "#1a1a1a", dash: "short" },
  ],
  latency: [
    { name: "compute", words: "all stages", colour: "#0068a8", dash: "solid" },
    { name: "latency", words: "age of the correction when it got to this page", colour: "#b8480a", dash: "short" },
  ],
};

/** Corrections; on cloth, and on the sky in light and dark. */
export const ARROW = "#4a3aff";
