import type { Drive, Method } from "./drive.ts";
import type { Panel } from "./panel.ts";
import { draw } from "./shapes.ts";
import type { State } from "./state.ts";
import type { Styles } from "./styles.ts";

const MARGIN = 16;
const LINE = 24;

/** The panels as they stand on the page, with a title, what the marks mean, and the command. */
export function picture(drive: Drive, panels: Panel[], stacked: boolean, state: State, styles: Styles): HTMLCanvasElement {
  const ratio = Math.max(...panels.map((panel) => panel.ratio));
  const [first] = panels;
  const [across, down] = stacked ? [1, panels.length] : [panels.length, 1];
  const width = across * (first.width + MARGIN) + MARGIN;
  const height = MARGIN + LINE + down * (first.height + LINE + MARGIN) + 2 * LINE;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
  const ink = canvas.getContext("2d");
  if (!ink) return canvas;
  const { ground } = styles;
  ink.scale(ratio, ratio);
  ink.fillStyle = ground.paper;
  ink.fillRect(0, 0, width, height);
  const text = (words: string, x: number, y: number, font: string, color: string, room: number) => {
    ink.font = `${font} system-ui, sans-serif`;
    ink.fillStyle = color;
    ink.fillText(words, x, y, room);
  };
  const name = drive.said.name.split(/[/\\]/).pop() ?? "";
  text(name, MARGIN, MARGIN + 14, "600 18px", ground.text, width - 2 * MARGIN);
  panels.forEach((panel, i) => {
    const left = MARGIN + (stacked ? 0 : i * (first.width + MARGIN));
    const top = MARGIN + 2 * LINE + (stacked ? i * (first.height + LINE + MARGIN) : 0);
    text(state.methods[i].words, left, top - 9, "600 15px", ground.text, panel.width);
    ink.save();
    ink.setTransform(1, 0, 0, 1, 0, 0);
    panel.copy(ink, Math.round(left * ratio), Math.round(top * ratio));
    ink.restore();
    ink.strokeStyle = ground.muted;
    ink.lineWidth = 0.5;
    ink.strokeRect(left, top, panel.width, panel.height);
  });
  const foot = height - LINE - 8;
  legend(ink, state.methods, state, styles, MARGIN, foot - 4, width - 2 * MARGIN);
  text(drive.said.command, MARGIN, foot + LINE - 2, "12px", ground.muted, width - 2 * MARGIN);
  return canvas;
}

function legend(
  ink: CanvasRenderingContext2D,
  methods: Method[],
  state: State,
  styles: Styles,
  left: number,
  y: number,
  room: number,
): void {
  const kinds = new Set(methods.flatMap((method) => method.kinds.filter((kind) => kind.x.length).map((kind) => kind.name)));
  let x = left;
  for (const name of kinds) {
    if (!state.shows(name)) continue;
    const { words, shape } = styles.of(name);
    ink.font = "13px system-ui, sans-serif";
    const wide = ink.measureText(words).width + 40;
    if (x + wide > left + room) return;
    draw(ink, shape, x + 6, y, 1.2, styles.color(name), styles.ground.rim);
    ink.fillStyle = styles.ground.text;
    ink.fillText(words, x + 17, y + 4.5);
    x += wide;
  }
}

/** Hands the picture to the browser as a file. */
export function save(canvas: HTMLCanvasElement, name: string): void {
  canvas.toBlob((blob) => {
    if (!blob) return;
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => {
      URL.revokeObjectURL(link.href);
    }, 10_000);
  });
}
