import type { Box, View } from "./camera.ts";
import { around, union } from "./camera.ts";
import type { Drive, Method } from "./drive.ts";
import { upper } from "./drive.ts";
import { drawArcs, drawBeams, drawChosen, drawGap, drawPath, drawRobot, drawWalls } from "./layers.ts";
import { gap, lines, shown } from "./measure.ts";
import { Sheet } from "./stamps.ts";
import type { State } from "./state.ts";
import type { Styles } from "./styles.ts";

/** Above so many marks they are drawn smaller, step by step. */
const MANY = [3_000, 20_000, 60_000];
const SIZES = [1.1, 0.9, 0.75, 0.6];

/** What one panel shows: lines and areas, marks over them, and in front what somebody asks for. */
export class Panel {
  private readonly ink: CanvasRenderingContext2D;
  private readonly sheet = new Sheet();
  width = 0;
  height = 0;
  ratio = 1;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly drive: Drive,
    private readonly styles: Styles,
  ) {
    const ink = canvas.getContext("2d", { alpha: false });
    if (!ink) throw new Error("this browser has no canvas");
    this.ink = ink;
  }

  /** Takes the size that the page gives it. */
  resize(): void {
    const box = this.canvas.getBoundingClientRect();
    this.ratio = Math.min(window.devicePixelRatio || 1, 2);
    [this.width, this.height] = [box.width, box.height];
    this.canvas.width = Math.max(1, Math.round(box.width * this.ratio));
    this.canvas.height = Math.max(1, Math.round(box.height * this.ratio));
  }

  view(state: State): View {
    return state.camera.view(this.width, this.height, this.ratio);
  }

  /** Draws the method at the state's time. */
  draw(method: Method, state: State): void {
    const { drive, styles } = this;
    const view = this.view(state);
    const pose = drive.poseAt(state.time);
    const { ink, canvas } = this;
    ink.fillStyle = styles.ground.paper;
    ink.fillRect(0, 0, canvas.width, canvas.height);
    if (state.shows("walls")) drawWalls(ink, view, drive, styles);
    if (state.shows("path")) drawPath(ink, view, drive, pose, styles);
    const present = state.shows("arcs") || state.shows("crossings") ? drive.present(pose) : [];
    if (state.shows("arcs")) drawArcs(ink, view, drive, present, styles);
    if (state.shows("cones")) drawBeams(ink, view, drive, drive.latest(pose), styles);
    this.sheet.clear(canvas.width, canvas.height);
    this.stamp(method, view, pose, present, state);
    this.sheet.show(ink);
    if (state.shows("robot")) drawRobot(ink, view, drive, state.time, styles);
    for (const line of lines(drive, state)) {
      const found = gap(line, shown(method, pose, state), drive.said.depth, drive.said.jamb);
      drawGap(ink, view, drive, line, found, styles, state.units, line === state.line);
    }
    if (state.chosen) drawChosen(ink, view, drive, state.chosen, state.chosen.method === method, styles);
  }

  private stamp(method: Method, view: View, pose: number, present: number[], state: State): void {
    const { drive, styles, sheet } = this;
    const { rim } = styles.ground;
    const size = this.size(method, state);
    const put = (name: string, x: ArrayLike<number>, y: ArrayLike<number>, count: number, by = 1) => {
      sheet.put(view, [x, y], count, styles.of(name).shape, size * by, styles.color(name), rim);
    };
    if (state.shows("truth")) put("truth", drive.truthX, drive.truthY, drive.truthX.length, 0.8);
    if (method.name === "atm") {
      if (state.shows("all crossings")) {
        put("crossings", drive.cx, drive.cy, upper(drive.on, drive.readingsAt(pose) - 1), 0.7);
      } else if (state.shows("crossings")) {
        const [x, y] = this.crossingsOf(present);
        put("crossings", x, y, x.length);
      }
    }
    const kinds = [...method.kinds].sort((a, b) => styles.rank(a.name) - styles.rank(b.name));
    for (const kind of kinds) {
      if (state.shows(kind.name)) put(kind.name, kind.x, kind.y, upper(kind.at, pose));
    }
  }

  /** Where the arcs of the local map cross. */
  private crossingsOf(present: number[]): [number[], number[]] {
    const [x, y] = [[] as number[], [] as number[]];
    for (const reading of present) {
      const [from, to] = this.drive.earlier(reading);
      for (let i = from; i < to; i++) {
        x.push(this.drive.cx[i]);
        y.push(this.drive.cy[i]);
      }
    }
    return [x, y];
  }

  /** Marks are smaller where there are many, and larger again where somebody zooms in. */
  private size(method: Method, state: State): number {
    const count = method.reading.length;
    const base = SIZES[MANY.filter((many) => count > many).length];
    const small = this.width < 420 ? 0.85 : 1;
    const zoom = state.camera.scale / Math.max(1e-9, this.fitted);
    return base * small * Math.min(1.8, Math.max(1, Math.sqrt(zoom)));
  }

  /** Pixels in a metre when everything is in the panel. */
  fitted = 1;

  /** What is shown, onto another canvas. */
  copy(onto: CanvasRenderingContext2D, x: number, y: number): void {
    onto.drawImage(this.canvas, x, y);
  }
}

/** Walls are fitted into the panel as far as this beyond the rest, in parts of its longer side. */
const WALL_ROOM = 0.3;

/** What a panel shows when everything is shown: the echoes and the path, and the walls where they are near. */
export function extent(drive: Drive): Box | null {
  let box = around(drive.x, drive.y);
  for (const method of drive.methods) box = union(box, around(method.x, method.y));
  const near = box;
  for (const { from, to, center, radius = 0 } of drive.said.world?.walls ?? []) {
    if (from && to) box = union(box, [Math.min(from[0], to[0]), Math.min(from[1], to[1]), Math.max(from[0], to[0]), Math.max(from[1], to[1])]);
    if (center) box = union(box, [center[0] - radius, center[1] - radius, center[0] + radius, center[1] + radius]);
  }
  if (!near || !box) return box;
  const room = WALL_ROOM * Math.max(near[2] - near[0], near[3] - near[1], 1);
  return [
    Math.max(box[0], near[0] - room),
    Math.max(box[1], near[1] - room),
    Math.min(box[2], near[2] + room),
    Math.min(box[3], near[3] + room),
  ];
}
