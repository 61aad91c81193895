import type { View } from "./camera.ts";
import type { Drive } from "./drive.ts";
import type { Gap } from "./measure.ts";
import type { Wall } from "./said.ts";
import { draw } from "./shapes.ts";
import type { Chosen, Line } from "./state.ts";
import { length } from "./state.ts";
import type { Styles } from "./styles.ts";

type Ink = CanvasRenderingContext2D;

/** Steps of the path shorter than this many pixels are joined. */
const SHORTEST = 0.7;
/** Arcs of the local map that are drawn, at most: more are a grey area. */
const MOST_ARCS = 4000;

export function drawWalls(ink: Ink, view: View, drive: Drive, styles: Styles): void {
  for (const wall of drive.said.world?.walls ?? []) drawWall(ink, view, wall, styles);
}

function drawWall(ink: Ink, view: View, { material, from, to, center, radius = 0 }: Wall, styles: Styles): void {
  ink.lineCap = "butt";
  ink.lineWidth = (material === "specular" ? 3 : 6) * view.ratio;
  ink.strokeStyle = ink.fillStyle = styles.color(material);
  ink.beginPath();
  if (from && to) {
    ink.moveTo(view.px(from[0]), view.py(from[1]));
    ink.lineTo(view.px(to[0]), view.py(to[1]));
    ink.stroke();
  } else if (center) {
    ink.arc(view.px(center[0]), view.py(center[1]), Math.max(1, radius * view.k), 0, 2 * Math.PI);
    ink.fill();
  }
}

/** The path: dotted as far as the robot is still to go. */
export function drawPath(ink: Ink, view: View, drive: Drive, pose: number, styles: Styles): void {
  const { x, y } = drive;
  const resets = new Set(drive.said.resets);
  ink.strokeStyle = styles.color("path");
  ink.lineJoin = "round";
  const stretch = (from: number, to: number) => {
    ink.beginPath();
    let [lastX, lastY] = [NaN, NaN];
    for (let i = from; i <= to; i++) {
      const [px, py] = [view.px(x[i]), view.py(y[i])];
      if (i === from || resets.has(i)) ink.moveTo(px, py);
      else if (i < to && Math.abs(px - lastX) + Math.abs(py - lastY) < SHORTEST) continue;
      else ink.lineTo(px, py);
      [lastX, lastY] = [px, py];
    }
    ink.stroke();
  };
  ink.lineWidth = 1 * view.ratio;
  ink.setLineDash([1.5 * view.ratio, 4 * view.ratio]);
  stretch(pose, x.length - 1);
  ink.setLineDash([]);
  ink.lineWidth = 1.8 * view.ratio;
  stretch(0, pose);
}

function rim(ink: Ink, view: View, drive: Drive, reading: number): void {
  const [heading, half] = [drive.heading[reading], drive.half[reading]];
  const radius = drive.range[reading] * view.k;
  const [x, y] = [view.px(drive.sx[reading]), view.py(drive.sy[reading])];
  // On the canvas y grows downwards, and angles with it.
  ink.arc(x, y, radius, -heading - half, -heading + half);
}

function start(ink: Ink, view: View, drive: Drive, reading: number): void {
  const [x, y] = drive.at(reading, drive.half[reading]);
  ink.moveTo(view.px(x), view.py(y));
}

/** The arcs of these readings. */
export function drawArcs(ink: Ink, view: View, drive: Drive, readings: number[], styles: Styles): void {
  const every = Math.ceil(readings.length / MOST_ARCS);
  ink.globalAlpha = readings.length > 300 ? 0.22 : 0.38;
  ink.strokeStyle = styles.color("arcs");
  ink.lineWidth = view.ratio;
  ink.beginPath();
  for (let i = 0; i < readings.length; i += every) {
    start(ink, view, drive, readings[i]);
    rim(ink, view, drive, readings[i]);
  }
  ink.stroke();
  ink.globalAlpha = 1;
}

/** The beams of these readings, filled up to their arcs. */
export function drawBeams(ink: Ink, view: View, drive: Drive, readings: number[], styles: Styles): void {
  ink.fillStyle = ink.strokeStyle = styles.color("arcs");
  ink.lineWidth = view.ratio;
  for (const reading of readings) {
    ink.beginPath();
    ink.moveTo(view.px(drive.sx[reading]), view.py(drive.sy[reading]));
    rim(ink, view, drive, reading);
    ink.closePath();
    ink.globalAlpha = 0.07;
    ink.fill();
    ink.globalAlpha = 0.25;
    ink.stroke();
  }
  ink.globalAlpha = 1;
}

/** The robot where it is at a time, between two poses. */
export function drawRobot(ink: Ink, view: View, drive: Drive, time: number, styles: Styles): void {
  const pose = drive.poseAt(time);
  const next = Math.min(pose + 1, drive.x.length - 1);
  const span = drive.clock[next] - drive.clock[pose];
  const apart = drive.said.resets.includes(next);
  const share = span > 0 && !apart ? Math.min(1, (time - drive.clock[pose]) / span) : 0;
  const turn = Math.atan2(Math.sin(drive.yaw[next] - drive.yaw[pose]), Math.cos(drive.yaw[next] - drive.yaw[pose]));
  const yaw = drive.yaw[pose] + share * turn;
  const x = view.px(drive.x[pose] + share * (drive.x[next] - drive.x[pose]));
  const y = view.py(drive.y[pose] + share * (drive.y[next] - drive.y[pose]));
  const radius = Math.max(drive.radius * view.k, 5 * view.ratio);
  ink.lineWidth = 1.5 * view.ratio;
  ink.strokeStyle = styles.color("robot");
  ink.fillStyle = styles.ground.body;
  ink.beginPath();
  ink.arc(x, y, radius, 0, 2 * Math.PI);
  ink.globalAlpha = 0.85;
  ink.fill();
  ink.globalAlpha = 1;
  ink.stroke();
  const at = (forward: number, left: number): [number, number] => [
    x + radius * (forward * Math.cos(yaw) - left * Math.sin(yaw)),
    y - radius * (forward * Math.sin(yaw) + left * Math.cos(yaw)),
  ];
  ink.fillStyle = styles.color("robot");
  ink.beginPath();
  ink.moveTo(...at(0.65, 0));
  ink.lineTo(...at(-0.4, 0.42));
  ink.lineTo(...at(-0.2, 0));
  ink.lineTo(...at(-0.4, -0.42));
  ink.closePath();
  ink.fill();
}

/** The beam of the chosen echo, the arcs that cross it, and a ring around it where the panel shows its method. */
export function drawChosen(ink: Ink, view: View, drive: Drive, { method, echo }: Chosen, own: boolean, styles: Styles): void {
  const reading = method.reading[echo];
  drawBeams(ink, view, drive, [reading], styles);
  const crossings = method.name === "atm" ? drive.crossingsOf(reading) : [];
  ink.strokeStyle = styles.color("crossings");
  ink.lineWidth = 1.1 * view.ratio;
  ink.globalAlpha = 0.75;
  ink.beginPath();
  for (const i of crossings) {
    const other = drive.on[i] === reading ? drive.with[i] : drive.on[i];
    start(ink, view, drive, other);
    rim(ink, view, drive, other);
  }
  ink.stroke();
  ink.globalAlpha = 1;
  ink.strokeStyle = styles.ground.text;
  ink.lineWidth = 2 * view.ratio;
  ink.beginPath();
  start(ink, view, drive, reading);
  rim(ink, view, drive, reading);
  ink.stroke();
  for (const i of crossings) {
    const [x, y] = [view.px(drive.cx[i]), view.py(drive.cy[i])];
    draw(ink, "dot", x, y, view.ratio, styles.color("crossings"), styles.ground.rim);
  }
  if (!own) return;
  ink.strokeStyle = styles.ground.ring;
  ink.lineWidth = 2 * view.ratio;
  ink.beginPath();
  ink.arc(view.px(method.x[echo]), view.py(method.y[echo]), 9 * view.ratio, 0, 2 * Math.PI);
  ink.stroke();
}

/** An opening: its width, with words above it or below it, the stretch that the echoes leave free, and how wide that is. */
export function drawGap(
  ink: Ink,
  view: View,
  drive: Drive,
  [ax, ay, bx, by]: Line,
  { free, width, marked }: Gap,
  styles: Styles,
  units: "m" | "in",
  below: boolean,
): void {
  if (!(width > 0)) return;
  const [ux, uy] = [(bx - ax) / width, (by - ay) / width];
  const at = (along: number, off: number): [number, number] => [
    view.px(ax + ux * along - uy * off),
    view.py(ay + uy * along + ux * off),
  ];
  const found = marked[0] && marked[1] ? free[1] - free[0] : 0;
  const color = styles.color(2 * found < width ? "shut" : "open");
  const depth = drive.said.depth;
  ink.fillStyle = color;
  ink.globalAlpha = 0.2;
  if (found > 0) {
    ink.beginPath();
    ink.moveTo(...at(free[0], depth));
    ink.lineTo(...at(free[1], depth));
    ink.lineTo(...at(free[1], -depth));
    ink.lineTo(...at(free[0], -depth));
    ink.closePath();
    ink.fill();
  }
  ink.globalAlpha = 1;
  ink.strokeStyle = styles.ground.text;
  ink.lineWidth = 1.4 * view.ratio;
  ink.beginPath();
  for (const end of [0, width]) {
    ink.moveTo(...at(end, depth));
    ink.lineTo(...at(end, -depth));
  }
  ink.moveTo(...at(0, 0));
  ink.lineTo(...at(width, 0));
  ink.stroke();
  const [x, y] = at(width / 2, 0);
  if (!(x > 0 && y > 0 && x < view.width * view.ratio && y < view.height * view.ratio)) return;
  const words = found > 0 ? `free: ${length(found, units)} of ${length(width, units)}` : "no echoes on its jambs";
  const edge = at(width / 2, ux >= 0 === below ? -depth : depth);
  label(ink, view, words, [edge[0], edge[1] + (below ? 36 * view.ratio : 0)], color, styles);
}

/** Words above a place, on the paper's colour so that they are read over anything. */
function label(ink: Ink, view: View, words: string, [x, y]: [number, number], color: string, styles: Styles): void {
  ink.font = `600 ${14 * view.ratio}px system-ui, sans-serif`;
  const half = ink.measureText(words).width / 2;
  const room = 6 * view.ratio;
  const middle = Math.min(Math.max(x, half + 2 * room), view.width * view.ratio - half - 2 * room);
  const bottom = Math.max(y - 2 * room, 26 * view.ratio);
  ink.fillStyle = styles.ground.paper;
  ink.globalAlpha = 0.88;
  ink.beginPath();
  ink.roundRect(middle - half - room, bottom - 18 * view.ratio, 2 * (half + room), 24 * view.ratio, 5 * view.ratio);
  ink.fill();
  ink.globalAlpha = 1;
  ink.fillStyle = color;
  ink.textAlign = "center";
  ink.fillText(words, middle, bottom);
  ink.textAlign = "start";
}
