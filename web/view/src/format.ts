import type { ColumnSaid, Said } from "./said.ts";

/** The columns by name, unpacked. */
export type Columns = (name: string) => Float64Array;

/** Reads the two parts of the page. */
export async function read(said: string, data: string): Promise<[Said, Columns]> {
  const parsed = JSON.parse(said) as Said;
  if (parsed.version !== 1) throw new Error(`format ${parsed.version} is not known here`);
  const bytes = await inflate(data.trim());
  if (bytes.byteLength !== parsed.columns.bytes) throw new Error("the file is damaged: its data is short");
  const columns = new Map(parsed.columns.list.map((column) => [column.name, unpack(column, bytes)]));
  return [parsed, (name) => columns.get(name) ?? new Float64Array(0)];
}

async function inflate(base64: string): Promise<ArrayBuffer> {
  const text = atob(base64);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).arrayBuffer();
}

function unpack({ type, offset, count, steps }: ColumnSaid, bytes: ArrayBuffer): Float64Array {
  const types = { i8: Int8Array, i16: Int16Array, i32: Int32Array, f32: Float32Array, f64: Float64Array };
  const values = Float64Array.from(new types[type](bytes, offset, count));
  if (steps) for (let i = 1; i < values.length; i++) values[i] += values[i - 1];
  return values;
}
