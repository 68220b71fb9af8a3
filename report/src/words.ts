// The names of the JSON report in plain English, by the glossary of the manual, and its values with their units.
import type { Json } from "./data";
import { digits, metres } from "./dom";

const LABELS: Record<string, string> = {
  after: "After",
  asked_m: "Gap that was asked for",
  before: "Before",
  between: "Who meets whom",
  bodies: "Bodies",
  certificate: "What readers of the file find, by a judge of its own",
  clean: "Clean",
  closed: "Closed (no boundary edge)",
  distortion: "How much the shape changed",
  gap: "Gap",
  history: "Iterations",
  infeasible: "Where the gap could not be opened",
  layers: "Layers",
  length_m: "Length",
  manifold: "Manifold",
  max_displacement_m: "Largest distance moved",
  max_edge_stretch: "Stretch of the worst edge (length after / before)",
  mean_displacement_m: "Mean distance moved",
  mean_edge_stretch: "Mean stretch of all edges",
  meetings: "Who intersects whom",
  method: "Method",
  min_distance_m: "Smallest distance",
  num_body_face_pairs: "Intersecting face pairs with bodies",
  num_boundary_edges: "Boundary edges",
  num_crossings: "Crossing face pairs, double precision",
  num_crossings_first_corner: "Crossing face pairs, polygons split from their first corner",
  num_crossings_single: "Crossing face pairs, single precision",
  num_edge_face_intersections: "Edge-face intersections",
  num_face_pairs: "Intersecting face pairs",
  num_faces: "Triangles",
  num_ignored_faces: "Ignored faces (a vertex is repeated)",
  num_iterations: "Iterations",
  num_moved_vertices: "Vertices that moved",
  num_overstretched_edges: "Overstretched edges",
  num_own_face_pairs: "Face pairs of its own",
  num_pairs_below: "Pairs of primitives nearer than the gap",
  num_pairs_below_before: "The same before",
  num_pieces: "Pieces",
  num_polygon_pairs: "Polygon pairs that cross however they are split",
  num_polygon_pairs_single: "The same, single precision",
  num_vertices: "Vertices",
  num_vertices_behind: "Vertices behind an inner layer",
  num_vertices_inside_body: "Vertices inside of a body",
  num_vertices_inside_body_single: "The same, single precision",
  num_welded_vertices: "Welded vertices (one with another in their place)",
  num_zeroed_coordinates: "Coordinates that count as zero",
  outputs: "Written",
  path_length_m: "Path length",
  path_pairs: "Paths by type",
  seconds: "Time",
  time_limit_reached: "Time limit reached",
  time_us: "Time of each stage",
};

export function label(name: string): string {
  const known = LABELS[name];
  if (known) return known;
  const plain = name
    .replace(/^num_/, "")
    .replace(/_(m|us|s)$/, "")
    .replaceAll("_", " ");
  return /[a-z]/.test(plain) ? plain.charAt(0).toUpperCase() + plain.slice(1) : plain;
}

/** A value with its unit, which its name has at the end. */
export function valueWords(name: string, value: Json): string {
  if (value === null) return "–";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") {
    if (/_m$/.test(name)) return metres(value);
    if (/_us$/.test(name)) return `${digits(value / 1000)} ms`;
    if (name === "seconds" || /_s$/.test(name)) return `${digits(value)} s`;
    return digits(value);
  }
  if (typeof value === "string") return value;
  if (Array.isArray(value) && value.length === 0) return "none";
  if (Array.isArray(value))
    return value.map((item) => valueWords(name, item)).join(name === "between" ? " and " : ", ");
  return Object.entries(value)
    .map(([key, item]) => `${label(key)} ${valueWords(key, item)}`)
    .join(", ");
}
