import { make } from "./dom.ts";
import type { Drive } from "./drive.ts";
import type { State } from "./state.ts";
import { length } from "./state.ts";
import type { Styles } from "./styles.ts";

/** The table: each method's echoes by kind, of the whole log. */
export function summary(table: HTMLTableElement, drive: Drive, styles: Styles): void {
  const methods = drive.methods;
  const head = make("tr", "", {}, make("th", "", { scope: "col" }));
  for (const method of methods) head.append(make("th", method.words, { scope: "col" }));
  const rows: HTMLTableRowElement[] = [];
  const row = (words: string, values: string[]) => {
    if (values.every((value) => value === "")) return;
    const line = make("tr", "", {}, make("th", words, { scope: "row" }));
    for (const value of values) line.append(make("td", value || "–"));
    rows.push(line);
  };
  const number = (value: number | undefined) => (value === undefined ? "" : value.toLocaleString("en"));
  // All methods are given the same readings.
  const counted = methods.find((method) => method.said.counts)?.said.counts;
  row("readings in the local map", methods.map(() => number(counted?.readings)));
  row("of them without an echo", methods.map(() => number(counted?.no_echo)));
  for (const kind of new Set(methods.flatMap((method) => method.said.kinds))) {
    const count = (method: (typeof methods)[0]) => {
      if (method.said.counts) return number(method.said.counts.echoes[kind]);
      return number(method.kinds.find((one) => one.name === kind)?.x.length);
    };
    row(styles.of(kind).words, methods.map(count));
  }
  row("no echo: two crossings", methods.map((method) => number(method.said.counts?.ignored_pairs)));
  const dropped = (counts: Record<string, number> | undefined) =>
    counts && number(Object.values(counts).reduce((sum, count) => sum + count, 0));
  row("unusable records", methods.map((method) => dropped(method.said.counts?.dropped) ?? ""));
  table.replaceChildren(make("thead", "", {}, head), make("tbody", "", {}, ...rows));
}

/** How long, how far, and with what settings. */
export function settings(table: HTMLTableElement, drive: Drive, state: State): void {
  const { said } = drive;
  const start = BigInt(said.origin.t);
  // Stamps since 1970 are dates; others are seconds of some clock.
  const date = start > 10n ** 17n ? new Date(Number(start / 1_000_000n)).toISOString() : `${Number(start) / 1e9} s`;
  const { x, y } = said.origin;
  const rows: [string, string][] = [
    ["duration", seconds(drive.elapsed[drive.elapsed.length - 1])],
    ["path", length(distance(drive), state.units)],
    ["sensors", String(said.sensors.length)],
    ["first pose", `${x.toFixed(3)}, ${y.toFixed(3)} m at ${date}`],
    ...said.settings,
  ];
  if (said.world) rows.push(["world", said.world.name]);
  const lines = rows.map(([words, value]) => make("tr", "", {}, make("th", words, { scope: "row" }), make("td", value)));
  table.replaceChildren(make("tbody", "", {}, ...lines));
}

export function distance({ x, y, said }: Drive): number {
  const resets = new Set(said.resets);
  let sum = 0;
  for (let i = 1; i < x.length; i++) if (!resets.has(i)) sum += Math.hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
  return sum;
}

export function seconds(value: number): string {
  if (value < 100) return `${value.toFixed(1)} s`;
  const whole = Math.floor(value);
  const pad = (part: number) => String(part).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours ? `${hours}:${pad(minutes)}:${pad(whole % 60)}` : `${minutes}:${pad(whole % 60)}`;
}
