import type { ShapeName } from "./said.ts";

/** Whether a shape is drawn by its outline alone. */
export function isStroked(shape: ShapeName): boolean {
  return shape === "plus" || shape === "cross" || shape === "line";
}

/** Half the room that a shape takes, in pixels of the page. */
export const REACH = 7;

/** The shape about (`x`, `y`), `size` times as large as usual. */
export function trace(path: CanvasPath, shape: ShapeName, x: number, y: number, size: number): void {
  const polygon = (...corners: [number, number][]) => {
    corners.forEach(([dx, dy], i) => {
      if (i === 0) path.moveTo(x + dx * size, y + dy * size);
      else path.lineTo(x + dx * size, y + dy * size);
    });
    path.closePath();
  };
  const line = (ax: number, ay: number, bx: number, by: number) => {
    path.moveTo(x + ax * size, y + ay * size);
    path.lineTo(x + bx * size, y + by * size);
  };
  const circle = (radius: number) => {
    path.moveTo(x + radius * size, y);
    path.arc(x, y, radius * size, 0, 2 * Math.PI);
  };
  const shapes: Record<ShapeName, () => void> = {
    disc: () => { circle(3.9); },
    dot: () => { circle(2.6); },
    speck: () => { circle(1.5); },
    plus: () => { line(-5.6, 0, 5.6, 0); line(0, -5.6, 0, 5.6); },
    cross: () => { line(-2.6, -2.6, 2.6, 2.6); line(-2.6, 2.6, 2.6, -2.6); },
    square: () => { polygon([-2.9, -2.9], [2.9, -2.9], [2.9, 2.9], [-2.9, 2.9]); },
    triangle: () => { polygon([0, -4], [3.8, 2.6], [-3.8, 2.6]); },
    nabla: () => { polygon([0, 4], [3.8, -2.6], [-3.8, -2.6]); },
    diamond: () => { polygon([0, -4.2], [4.2, 0], [0, 4.2], [-4.2, 0]); },
    line: () => { line(-5, 0, 5, 0); },
  };
  shapes[shape]();
}

type Ink = CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D;

/** Draws one mark with a rim that sets it off from what it lies on. */
export function draw(ink: Ink, shape: ShapeName, x: number, y: number, size: number, color: string, rim: string): void {
  ink.beginPath();
  trace(ink, shape, x, y, size);
  ink.lineJoin = "round";
  ink.lineCap = "round";
  if (isStroked(shape)) {
    // Without a rim, which would hide the marks below: a cross lies on a disc, and both are seen.
    ink.strokeStyle = color;
    ink.lineWidth = 1.5 * size;
    ink.stroke();
    return;
  }
  if (shape !== "speck") {
    ink.strokeStyle = rim;
    ink.lineWidth = 1.6 * size;
    ink.stroke();
  }
  ink.fillStyle = color;
  ink.fill();
}
