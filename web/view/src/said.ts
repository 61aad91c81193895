/** What the page says of the drive, beside the columns: `docs/view.md`. */
export interface Said {
  version: number;
  name: string;
  command: string;
  /** Of all coordinates; `t` in nanoseconds, as text since it may not fit a number. */
  origin: { t: string; x: number; y: number };
  units: "m" | "in";
  /** Metres, radians, parts of half a beam in a whole number's 1. */
  steps: { length: number; angle: number; azimuths: number };
  sensors: string[];
  /** Poses before which the clock was set back. */
  resets: number[];
  thinned: { stride: number; readings: number };
  methods: MethodSaid[];
  settings: [string, string][];
  styles: Style[];
  world: World | null;
  columns: { bytes: number; list: ColumnSaid[] };
  /** A point within this of the line between two jambs stands in the opening; within `jamb` of one along the line it marks it. */
  depth: number;
  jamb: number;
}

export interface MethodSaid {
  name: "centerline" | "atm" | "consensus";
  kinds: string[];
  counts: Counts | null;
}

/** The counts of `atm fuse --summary`. */
export interface Counts {
  readings: number;
  no_echo: number;
  echoes: Record<string, number>;
  ignored_pairs: number;
  skipped: Record<string, number>;
  dropped: Record<string, number>;
  clock_resets: number;
}

export type ShapeName =
  | "disc"
  | "dot"
  | "speck"
  | "plus"
  | "cross"
  | "square"
  | "triangle"
  | "nabla"
  | "diamond"
  | "line";

export interface Style {
  name: string;
  words: string;
  shape: ShapeName;
  light: string;
  dark: string;
}

export interface Wall {
  material: string;
  from?: [number, number];
  to?: [number, number];
  center?: [number, number];
  radius?: number;
}

export type Jambs = [[number, number], [number, number]];

export interface World {
  name: string;
  walls: Wall[];
  openings: Jambs[];
}

export interface ColumnSaid {
  name: string;
  type: "i8" | "i16" | "i32" | "f32" | "f64";
  offset: number;
  count: number;
  /** Each number less the one before it. */
  steps: boolean;
}
