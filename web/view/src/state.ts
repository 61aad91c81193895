import { Camera } from "./camera.ts";
import type { Method } from "./drive.ts";

/** A line from jamb to jamb, measured by hand. */
export type Line = [number, number, number, number];

/** One echo, or an arc without one. */
export interface Chosen {
  method: Method;
  echo: number;
}

/** What is shown now. */
export class State {
  readonly camera = new Camera();
  /** Of the replay's clock, in seconds. */
  time = 0;
  playing = false;
  /** Seconds of the drive in one of the clock on the wall. */
  speed = 1;
  /** Layers and kinds that are not shown. */
  readonly hidden = new Set<string>();
  /** The methods of the panels. */
  methods: Method[] = [];
  units: "m" | "in" = "m";
  measuring = false;
  line: Line | null = null;
  chosen: Chosen | null = null;

  shows(layer: string): boolean {
    return !this.hidden.has(layer);
  }
}

/** A length for a person. */
export function length(metres: number, units: "m" | "in", digits?: number): string {
  if (units === "in") return `${(metres / 0.0254).toFixed(digits ?? (metres < 0.254 ? 1 : 0))} in`;
  return metres < 1 ? `${(metres * 100).toFixed(digits ?? (metres < 0.1 ? 1 : 0))} cm` : `${metres.toFixed(digits ?? 2)} m`;
}
