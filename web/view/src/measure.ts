import type { Drive, Method } from "./drive.ts";
import { upper } from "./drive.ts";
import type { Line, State } from "./state.ts";

/** What the echoes say of an opening. */
export interface Gap {
  /** The largest free stretch, in metres from the first jamb. */
  free: [number, number];
  width: number;
  /** Whether there are echoes at the first and at the second jamb. */
  marked: [boolean, boolean];
}

/** What the points leave free between the two ends of a line: the rule of `atm eval`. */
export function gap([ax, ay, bx, by]: Line, points: Iterable<[number, number]>, depth: number, jamb: number): Gap {
  const width = Math.hypot(bx - ax, by - ay);
  const [ux, uy] = [(bx - ax) / width, (by - ay) / width];
  const stops = [0, width];
  const marked: [boolean, boolean] = [false, false];
  for (const [x, y] of points) {
    const [dx, dy] = [x - ax, y - ay];
    if (!(Math.abs(ux * dy - uy * dx) <= depth)) continue;
    const place = ux * dx + uy * dy;
    if (Math.abs(place) <= jamb) marked[0] = true;
    if (Math.abs(place - width) <= jamb) marked[1] = true;
    if (place >= 0 && place <= width) stops.push(place);
  }
  stops.sort((a, b) => a - b);
  let free: [number, number] = [0, 0];
  for (let i = 1; i < stops.length; i++) {
    if (stops[i] - stops[i - 1] > free[1] - free[0]) free = [stops[i - 1], stops[i]];
  }
  return { free, width, marked };
}

/** The echoes of a method that are shown at a pose. */
export function* shown(method: Method, pose: number, state: State): Generator<[number, number]> {
  for (const kind of method.kinds) {
    if (!state.shows(kind.name)) continue;
    const count = upper(kind.at, pose);
    for (let i = 0; i < count; i++) yield [kind.x[i], kind.y[i]];
  }
}

/** The lines that are measured: the world's openings, and the one that was drawn by hand. */
export function lines(drive: Drive, state: State): Line[] {
  const openings = state.shows("opening") ? (drive.said.world?.openings ?? []) : [];
  const all = openings.map(([from, to]): Line => [...from, ...to]);
  return state.line ? [...all, state.line] : all;
}
