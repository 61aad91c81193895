/** A rectangle of the plane: left, bottom, right, top, in metres. */
export type Box = [number, number, number, number];

/** What part of the plane all panels show. */
export class Camera {
  constructor(
    public x = 0,
    public y = 0,
    /** Pixels of the page in a metre. */
    public scale = 50,
  ) {}

  /** Shows the whole box in a panel of this size. */
  fit([left, bottom, right, top]: Box, width: number, height: number): void {
    [this.x, this.y] = [(left + right) / 2, (bottom + top) / 2];
    this.scale = Math.max(1e-6, Math.min(width / Math.max(right - left, 0.5), height / Math.max(top - bottom, 0.5)) * 0.92);
  }

  /** Zooms, with the point at (`x`, `y`) of a panel of this size staying where it is. */
  zoom(factor: number, x: number, y: number, width: number, height: number): void {
    const scale = Math.min(1e5, Math.max(1e-4, this.scale * factor));
    const [px, py] = [x - width / 2, height / 2 - y];
    this.x += px / this.scale - px / scale;
    this.y += py / this.scale - py / scale;
    this.scale = scale;
  }

  pan(dx: number, dy: number): void {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
  }

  /** As seen in a panel of this size. */
  view(width: number, height: number, ratio: number): View {
    return new View(this.x, this.y, this.scale, width, height, ratio);
  }
}

/** One panel's view: from metres to its canvas's pixels. */
export class View {
  /** Pixels of the canvas in a metre. */
  readonly k: number;
  readonly left: number;
  readonly top: number;

  constructor(
    x: number,
    y: number,
    scale: number,
    /** Of the panel, in pixels of the page. */
    readonly width: number,
    readonly height: number,
    /** Pixels of the canvas in one of the page. */
    readonly ratio: number,
  ) {
    this.k = scale * ratio;
    this.left = (width * ratio) / 2 - x * this.k;
    this.top = (height * ratio) / 2 + y * this.k;
  }

  px(x: number): number {
    return this.left + x * this.k;
  }

  py(y: number): number {
    return this.top - y * this.k;
  }

  /** The point of the plane at a point of the panel. */
  plane(x: number, y: number): [number, number] {
    return [(x * this.ratio - this.left) / this.k, (this.top - y * this.ratio) / this.k];
  }
}

/** The box that holds all points but the few that lie far away from the rest: 2 % on either side of each axis. */
export function around(xs: ArrayLike<number>, ys: ArrayLike<number>): Box | null {
  const x = stretch(xs);
  const y = stretch(ys);
  return x && y && [x[0], y[0], x[1], y[1]];
}

function stretch(values: ArrayLike<number>): [number, number] | null {
  if (values.length === 0) return null;
  const sorted = Float64Array.from(values).sort();
  const last = sorted.length - 1;
  const stray = sorted.length < 8 ? 0 : Math.ceil(last * 0.02);
  const [low, high] = [sorted[stray], sorted[last - stray]];
  const far = Math.max(high - low, 1);
  return [Math.max(sorted[0], low - far), Math.min(sorted[last], high + far)];
}

export function union(one: Box | null, other: Box | null): Box | null {
  if (!one || !other) return one ?? other;
  return [
    Math.min(one[0], other[0]),
    Math.min(one[1], other[1]),
    Math.max(one[2], other[2]),
    Math.max(one[3], other[3]),
  ];
}
