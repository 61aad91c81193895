import type { Columns } from "./format.ts";
import type { MethodSaid, Said } from "./said.ts";

/** A gap of the log that is longer, in seconds, is played as one of a second. */
const LONGEST_GAP = 10;
/** Where the clock was set back, the replay goes on after this, in seconds. */
const RESET = 0.1;

/** Echoes of one kind of one method, in the order in which they settle. */
export interface Kind {
  name: string;
  x: Float32Array;
  y: Float32Array;
  /** The pose at which each was reported. */
  at: Int32Array;
  /** Its place among the method's echoes. */
  index: Int32Array;
}

/** One method's echoes. */
export class Method {
  readonly kinds: Kind[];

  constructor(
    readonly said: MethodSaid,
    readonly reading: Float64Array,
    readonly kind: Uint8Array,
    /** From the boresight, in radians. */
    readonly azimuth: Float32Array,
    readonly crossings: Float64Array,
    /** In metres. */
    readonly resolution: Float64Array,
    readonly significance: Float64Array,
    readonly x: Float32Array,
    readonly y: Float32Array,
    at: Int32Array,
  ) {
    const order = Int32Array.from(reading.keys()).sort((a, b) => at[a] - at[b] || a - b);
    this.kinds = said.kinds.map((name, kindIndex) => {
      const index = order.filter((echo) => kind[echo] === kindIndex);
      return {
        name,
        x: Float32Array.from(index, (echo) => x[echo]),
        y: Float32Array.from(index, (echo) => y[echo]),
        at: Int32Array.from(index, (echo) => at[echo]),
        index,
      };
    });
  }

  get name(): string {
    return this.said.name;
  }

  get words(): string {
    return { centerline: "cone centres", atm: "atm: median", consensus: "atm: consensus" }[this.said.name];
  }
}

/** Everything that is replayed; metres from the origin, radians, seconds of the replay's clock. */
export class Drive {
  /** Of poses: the replay's clock, and seconds since the first pose. */
  readonly clock: Float64Array;
  readonly elapsed: Float64Array;
  readonly x: Float64Array;
  readonly y: Float64Array;
  readonly yaw: Float64Array;
  /** Of readings: the pose, the sensor's number, the range (0: no echo), the pose at which it left the local map. */
  readonly pose: Int32Array;
  readonly sensor: Int32Array;
  readonly range: Float64Array;
  readonly left: Int32Array;
  /** The sensor's place and heading, and half its beam. */
  readonly sx: Float64Array;
  readonly sy: Float64Array;
  readonly heading: Float64Array;
  readonly half: Float64Array;
  /** Crossings by the later of their two readings. */
  readonly on: Int32Array;
  readonly with: Int32Array;
  readonly cx: Float32Array;
  readonly cy: Float32Array;
  readonly methods: Method[];
  readonly truthX: Float64Array;
  readonly truthY: Float64Array;
  /** The robot's radius. */
  readonly radius: number;
  /** Crossings of each reading with later ones: `byWith` from `starts[reading]` on. */
  private readonly starts: Int32Array;
  private readonly byWith: Int32Array;
  private readonly longest: number;

  constructor(
    readonly said: Said,
    columns: Columns,
  ) {
    const { length, angle, azimuths } = said.steps;
    const scaled = (name: string, step: number) => columns(name).map((value) => value * step);
    this.elapsed = scaled("pose.t", 1e-6);
    this.clock = played(this.elapsed);
    [this.x, this.y, this.yaw] = [scaled("pose.x", length), scaled("pose.y", length), scaled("pose.yaw", angle)];
    this.pose = Int32Array.from(columns("reading.pose"));
    this.sensor = Int32Array.from(columns("reading.sensor"));
    this.range = scaled("reading.range", length);
    this.left = Int32Array.from(columns("reading.left"), (stay, i) => this.pose[i] + stay);
    this.longest = columns("reading.left").reduce((most, stay) => Math.max(most, stay), 0);
    const mount = Int32Array.from(columns("reading.mount"));
    const [mx, my] = [scaled("mount.x", length), scaled("mount.y", length)];
    const [myaw, mhalf] = [scaled("mount.yaw", angle), scaled("mount.half", angle)];
    const count = this.pose.length;
    [this.sx, this.sy] = [new Float64Array(count), new Float64Array(count)];
    [this.heading, this.half] = [new Float64Array(count), new Float64Array(count)];
    for (let i = 0; i < count; i++) {
      const [pose, at] = [this.pose[i], mount[i]];
      const [cos, sin] = [Math.cos(this.yaw[pose]), Math.sin(this.yaw[pose])];
      this.sx[i] = this.x[pose] + cos * mx[at] - sin * my[at];
      this.sy[i] = this.y[pose] + sin * mx[at] + cos * my[at];
      this.heading[i] = this.yaw[pose] + myaw[at];
      this.half[i] = mhalf[at];
    }
    this.radius = Math.max(0.05, ...mx.subarray(0, 4096).map((x, i) => Math.hypot(x, my[i])));
    this.on = Int32Array.from(columns("crossing.on"));
    this.with = Int32Array.from(columns("crossing.back"), (back, i) => this.on[i] - back);
    const azimuth = columns("crossing.azimuth");
    [this.cx, this.cy] = [new Float32Array(this.on.length), new Float32Array(this.on.length)];
    for (let i = 0; i < this.on.length; i++) {
      const reading = this.on[i];
      const [x, y] = this.at(reading, (azimuth[i] / azimuths) * this.half[reading]);
      this.cx[i] = x;
      this.cy[i] = y;
    }
    [this.starts, this.byWith] = grouped(this.with, count);
    this.methods = said.methods.map((method) => this.method(method, columns));
    [this.truthX, this.truthY] = [scaled("truth.x", length), scaled("truth.y", length)];
  }

  /** The point of a reading's arc at an azimuth. */
  at(reading: number, azimuth: number): [number, number] {
    const bearing = this.heading[reading] + azimuth;
    const range = this.range[reading];
    return [this.sx[reading] + range * Math.cos(bearing), this.sy[reading] + range * Math.sin(bearing)];
  }

  private method(said: MethodSaid, columns: Columns): Method {
    const column = (name: string) => columns(`${said.name}.${name}`);
    const centres = said.name === "centerline";
    let reading = column("reading");
    if (centres) reading = Float64Array.from(this.range.keys()).filter((i) => this.range[i] > 0);
    const { length, azimuths } = this.said.steps;
    const part = column("azimuth");
    const azimuth = Float32Array.from(reading, (r, i) => (centres ? 0 : (part[i] / azimuths) * this.half[r]));
    const [x, y] = [new Float32Array(reading.length), new Float32Array(reading.length)];
    const at = new Int32Array(reading.length);
    reading.forEach((r, i) => {
      const [px, py] = this.at(r, azimuth[i]);
      [x[i], y[i], at[i]] = [px, py, centres ? this.pose[r] : this.left[r]];
    });
    const kind = centres ? new Uint8Array(reading.length) : Uint8Array.from(column("kind"));
    const resolution = centres
      ? Float64Array.from(reading, (r) => 2 * this.half[r] * this.range[r])
      : column("resolution").map((value) => value * length);
    const crossings = centres ? new Float64Array(reading.length) : column("crossings");
    const significance = centres ? new Float64Array(reading.length).fill(1) : column("significance");
    return new Method(said, reading, kind, azimuth, crossings, resolution, significance, x, y, at);
  }

  get duration(): number {
    return this.clock[this.clock.length - 1];
  }

  /** The pose that holds at a time of the clock. */
  poseAt(time: number): number {
    return Math.max(0, upper(this.clock, time) - 1);
  }

  /** Readings taken up to a pose, itself included. */
  readingsAt(pose: number): number {
    return upper(this.pose, pose);
  }

  /** Readings with an echo that are in the local map at a pose. */
  present(pose: number): number[] {
    const found = [];
    const end = this.readingsAt(pose);
    for (let i = upper(this.pose, pose - this.longest - 1); i < end; i++) {
      if (this.left[i] >= pose && this.range[i] > 0) found.push(i);
    }
    return found;
  }

  /** The latest reading of each sensor of this moment. */
  latest(pose: number): number[] {
    const [found, seen] = [[] as number[], new Set<number>()];
    const end = this.readingsAt(pose);
    const oldest = this.clock[pose] - 2;
    for (let i = end - 1; i >= 0 && i > end - 2000 && this.clock[this.pose[i]] >= oldest; i--) {
      if (seen.has(this.sensor[i])) continue;
      seen.add(this.sensor[i]);
      if (this.range[i] > 0) found.push(i);
      if (seen.size >= this.said.sensors.length) break;
    }
    return found;
  }

  /** Crossings on a reading's arc with readings before it: from, to. */
  earlier(reading: number): [number, number] {
    return [lower(this.on, reading), upper(this.on, reading)];
  }

  /** All crossings on a reading's arc. */
  crossingsOf(reading: number): number[] {
    const [from, to] = this.earlier(reading);
    const all = Array.from(this.byWith.subarray(this.starts[reading], this.starts[reading + 1]));
    for (let i = from; i < to; i++) all.push(i);
    return all;
  }
}

/** Items by the number they belong to: where each number's begin, and the items. */
function grouped(of: Int32Array, count: number): [Int32Array, Int32Array] {
  const starts = new Int32Array(count + 1);
  for (const number of of) starts[number + 1]++;
  for (let i = 0; i < count; i++) starts[i + 1] += starts[i];
  const [next, items] = [starts.slice(), new Int32Array(of.length)];
  of.forEach((number, item) => {
    items[next[number]++] = item;
  });
  return [starts, items];
}

/** The replay's clock: it never goes back, and does not wait long. */
function played(elapsed: Float64Array): Float64Array {
  const clock = new Float64Array(elapsed.length);
  for (let i = 1; i < elapsed.length; i++) {
    const step = elapsed[i] - elapsed[i - 1];
    clock[i] = clock[i - 1] + (step < 0 ? RESET : step > LONGEST_GAP ? 1 : step);
  }
  return clock;
}

/** How many numbers of a sorted column are at most `value`. */
export function upper(sorted: ArrayLike<number>, value: number): number {
  let [low, high] = [0, sorted.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low;
}

function lower(sorted: ArrayLike<number>, value: number): number {
  return upper(sorted, value - 1);
}
