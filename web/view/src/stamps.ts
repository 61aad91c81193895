import type { View } from "./camera.ts";
import type { ShapeName } from "./said.ts";
import { REACH, draw } from "./shapes.ts";

/** A mark as pixels, to be stamped: where from its middle, and what colour. */
interface Stamp {
  dx: Int16Array;
  dy: Int16Array;
  color: Uint32Array;
}

const MOST_STAMPS = 200;
/** Of more marks at once, pixels are covered or not: none is half covered, which takes time. */
const SMOOTH = 20_000;

/** Pixels onto which marks are stamped: a hundred thousand of them in a few milliseconds, where paths would take ten times as long. */
export class Sheet {
  private image = new ImageData(1, 1);
  private pixels = new Uint32Array(this.image.data.buffer);
  /** By pixel, the mark that was stamped there last. */
  private taken = new Uint8Array(1);
  private readonly stamps = new Map<string, Stamp>();
  private mark = 0;
  private readonly ink = document.createElement("canvas").getContext("2d", { willReadFrequently: true });

  /** Empties the sheet, which is as large as the canvas from now on. */
  clear(width: number, height: number): void {
    if (this.image.width !== width || this.image.height !== height) {
      this.image = new ImageData(Math.max(1, width), Math.max(1, height));
      this.pixels = new Uint32Array(this.image.data.buffer);
      this.taken = new Uint8Array(this.pixels.length);
    } else {
      this.pixels.fill(0);
      this.taken.fill(0);
    }
    this.mark = 0;
  }

  /** Lays the sheet over what is on a canvas. */
  show(ink: CanvasRenderingContext2D): void {
    const { width, height } = this.image;
    const canvas = this.ink?.canvas;
    if (!this.ink || !canvas) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    this.ink.putImageData(this.image, 0, 0);
    ink.drawImage(canvas, 0, 0);
  }

  /** Stamps the first `count` points. */
  put(
    view: View,
    [x, y]: [ArrayLike<number>, ArrayLike<number>],
    count: number,
    shape: ShapeName,
    size: number,
    color: string,
    rim: string,
  ): void {
    const stamp = this.stamp(shape, Math.round(size * view.ratio * 8) / 8, color, rim, count <= SMOOTH);
    const { width, height } = this.image;
    const { k, left, top } = view;
    const reach = Math.ceil(REACH * size * view.ratio);
    const mark = (this.mark = (this.mark % 255) + 1);
    for (let i = 0; i < count; i++) {
      const px = Math.round(left + x[i] * k);
      const py = Math.round(top - y[i] * k);
      if (!(px > -reach && py > -reach && px < width + reach && py < height + reach)) continue;
      const whole = px >= reach && py >= reach && px < width - reach && py < height - reach;
      if (whole) {
        // The same mark in the same pixel changes nothing.
        const place = py * width + px;
        if (this.taken[place] === mark) continue;
        this.taken[place] = mark;
        this.whole(stamp, place, width);
      } else {
        this.cut(stamp, px, py);
      }
    }
  }

  private whole({ dx, dy, color }: Stamp, place: number, width: number): void {
    const pixels = this.pixels;
    for (let j = 0; j < color.length; j++) {
      const at = place + dy[j] * width + dx[j];
      const ink = color[j];
      pixels[at] = ink >>> 24 === 255 ? ink : over(ink, pixels[at]);
    }
  }

  private cut({ dx, dy, color }: Stamp, px: number, py: number): void {
    const { width, height } = this.image;
    for (let j = 0; j < color.length; j++) {
      const [x, y] = [px + dx[j], py + dy[j]];
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      this.pixels[y * width + x] = over(color[j], this.pixels[y * width + x]);
    }
  }

  private stamp(shape: ShapeName, size: number, color: string, rim: string, smooth: boolean): Stamp {
    const key = `${shape} ${size} ${color} ${rim} ${String(smooth)}`;
    const known = this.stamps.get(key);
    if (known) return known;
    if (this.stamps.size > MOST_STAMPS) this.stamps.clear();
    const stamp = made(shape, size, color, rim, smooth);
    this.stamps.set(key, stamp);
    return stamp;
  }
}

function made(shape: ShapeName, size: number, color: string, rim: string, smooth: boolean): Stamp {
  const reach = Math.ceil(REACH * size);
  const side = 2 * reach + 1;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = side;
  const ink = canvas.getContext("2d", { willReadFrequently: true });
  const [dx, dy, colors] = [[] as number[], [] as number[], [] as number[]];
  if (ink) {
    draw(ink, shape, reach + 0.5, reach + 0.5, size, color, rim);
    const pixels = new Uint32Array(ink.getImageData(0, 0, side, side).data.buffer);
    pixels.forEach((pixel, i) => {
      if (pixel >>> 24 < (smooth ? 8 : 128)) return;
      dx.push((i % side) - reach);
      dy.push(Math.floor(i / side) - reach);
      colors.push(smooth ? pixel : (pixel | 0xff000000) >>> 0);
    });
  }
  return { dx: Int16Array.from(dx), dy: Int16Array.from(dy), color: Uint32Array.from(colors) };
}

/** One colour over another; not premultiplied, 0xAABBGGRR. */
function over(ink: number, paper: number): number {
  const a = ink >>> 24;
  const b = paper >>> 24;
  if (a === 255 || b === 0) return ink;
  const below = (b * (255 - a)) / 255;
  const alpha = a + below;
  const part = (shift: number) =>
    ((((ink >>> shift) & 255) * a + ((paper >>> shift) & 255) * below) / alpha + 0.5) << shift;
  return ((Math.round(alpha) << 24) | (part(16) & 0xff0000) | (part(8) & 0xff00) | (part(0) & 0xff)) >>> 0;
}
