import type { View } from "./camera.ts";
import type { Drive, Method } from "./drive.ts";
import { upper } from "./drive.ts";
import type { Chosen, State } from "./state.ts";
import { length } from "./state.ts";

/** What each kind says, for a person. */
const KINDS: Record<string, string> = {
  centerline: "the centre of the cone: no better than the beam is wide",
  median: "the median of the arc's crossings",
  single: "the arc's one crossing",
  center: "nothing crosses the arc: the centre of its cone",
  near: "the arc is short enough as it is",
  pair: "two crossings",
  point: "a point that the readings agree on",
  wall: "a wall that the readings agree on",
};

/** The echo nearest to a point of the panel, within `reach` pixels of the page. */
export function pick(method: Method, view: View, pose: number, state: State, x: number, y: number, reach: number): number | null {
  const [px, py] = view.plane(x, y);
  let nearest = ((reach * view.ratio) / view.k) ** 2;
  let found: number | null = null;
  for (const kind of method.kinds) {
    if (!state.shows(kind.name)) continue;
    const count = upper(kind.at, pose);
    for (let i = 0; i < count; i++) {
      const distance = (kind.x[i] - px) ** 2 + (kind.y[i] - py) ** 2;
      if (distance <= nearest) [nearest, found] = [distance, kind.index[i]];
    }
  }
  return found;
}

/** The echo that settled before or after this one, of those that are shown. */
export function neighbour(method: Method, pose: number, state: State, from: number | null, step: 1 | -1): number | null {
  const all: [number, number][] = [];
  for (const kind of method.kinds) {
    if (!state.shows(kind.name)) continue;
    const count = upper(kind.at, pose);
    for (let i = 0; i < count; i++) all.push([kind.at[i], kind.index[i]]);
  }
  all.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const here = all.findIndex(([, echo]) => echo === from);
  const next = here < 0 ? (step > 0 ? 0 : all.length - 1) : here + step;
  return next >= 0 && next < all.length ? all[next][1] : null;
}

/** What is said of an echo, row by row. */
export function details(drive: Drive, { method, echo }: Chosen, units: "m" | "in"): [string, string][] {
  const reading = method.reading[echo];
  const kind = method.kinds[method.kind[echo]]?.name ?? "";
  const metres = (value: number) => length(value, units, units === "in" ? 1 : undefined);
  const consensus = method.name === "consensus";
  const elapsed = drive.elapsed[drive.pose[reading]];
  const rows: [string, string][] = [
    ["kind", `${kind === "centerline" ? "cone centre" : kind}: ${KINDS[kind] ?? ""}`],
    ["sensor", drive.said.sensors[drive.sensor[reading]] ?? String(drive.sensor[reading])],
    ["time", `${elapsed.toFixed(2)} s`],
    ["range", metres(drive.range[reading])],
    ["azimuth", `${((method.azimuth[echo] * 180) / Math.PI).toFixed(2)}°`],
    ["resolution", metres(method.resolution[echo])],
  ];
  if (method.name === "centerline") return rows;
  rows.push([consensus ? "agreeing readings" : "crossings", String(method.crossings[echo])]);
  rows.push([consensus ? "missing confidence" : "significance", probability(method.significance[echo])]);
  const { x, y } = drive.said.origin;
  rows.push(["place", `${(x + method.x[echo]).toFixed(3)}, ${(y + method.y[echo]).toFixed(3)} m`]);
  return rows;
}

function probability(value: number): string {
  return value >= 0.01 || value === 0 ? value.toFixed(3) : value.toExponential(1);
}
