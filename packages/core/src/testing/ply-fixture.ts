import { coefficientsPerSplat, type ShDegree } from '../data/splats/splat-set.ts';

/** A property of a test file: `values[row]`, the items of a list if `countType` is given. */
export interface FixtureProperty {
  readonly name: string;
  /** As written in the header, e.g. `float` or `uint8`. */
  readonly type: string;
  readonly countType?: string;
  readonly values: readonly (number | readonly number[])[];
}

export interface FixtureElement {
  readonly name: string;
  readonly count: number;
  readonly properties: readonly FixtureProperty[];
}

export interface Fixture {
  readonly format: 'ascii' | 'binary_little_endian' | 'binary_big_endian';
  readonly elements: readonly FixtureElement[];
  readonly lineEnd?: string;
  /** Lines after the format line. */
  readonly comments?: readonly string[];
}

/** The 14 required properties of splats, in the standard order. */
export const CORE_NAMES = [
  ...['x', 'y', 'z', 'f_dc_0', 'f_dc_1', 'f_dc_2', 'opacity'],
  ...['scale_0', 'scale_1', 'scale_2', 'rot_0', 'rot_1', 'rot_2', 'rot_3'],
];

export function splatNames(degree: ShDegree): string[] {
  const rest = Array.from({ length: coefficientsPerSplat(degree) }, (_, i) => `f_rest_${i}`);
  return [...CORE_NAMES, ...rest];
}

/** Splats with a small distinct value everywhere, or with the values of `valueAt`. */
export function splatElement(
  count: number,
  degree: ShDegree = 0,
  valueAt: (name: string, row: number) => number = distinctValue,
): FixtureElement {
  const properties = splatNames(degree).map((name) => ({
    name,
    type: 'float',
    values: Array.from({ length: count }, (_, row) => valueAt(name, row)),
  }));
  return { name: 'vertex', count, properties };
}

/** Exact in float32 and short in decimal. */
export function distinctValue(name: string, row: number): number {
  return ((splatNames(3).indexOf(name) * 7 + row * 13) % 101) / 32 - 1;
}

/** The bytes of a PLY, written without any of the code under test. */
export function plyBytes(fixture: Fixture): Uint8Array<ArrayBuffer> {
  const header = new TextEncoder().encode(headerText(fixture));
  const body =
    fixture.format === 'ascii' ? new TextEncoder().encode(asciiBody(fixture)) : binaryBody(fixture);
  const bytes = new Uint8Array(header.length + body.length);
  bytes.set(header);
  bytes.set(body, header.length);
  return bytes;
}

/** The same bytes in chunks of the given sizes, repeated. */
export function chunked(bytes: Uint8Array, sizes: readonly number[]): ReadableStream<Uint8Array> {
  let offset = 0;
  let turn = 0;
  return new ReadableStream({
    pull(controller) {
      if (offset >= bytes.length) return controller.close();
      const size = sizes[turn++ % sizes.length];
      controller.enqueue(bytes.slice(offset, offset + size));
      offset += size;
    },
  });
}

function headerText({ format, elements, lineEnd = '\n', comments = [] }: Fixture): string {
  const lines = ['ply', `format ${format} 1.0`, ...comments];
  for (const element of elements) {
    lines.push(`element ${element.name} ${element.count}`);
    for (const { name, type, countType } of element.properties) {
      lines.push(`property ${countType ? `list ${countType} ` : ''}${type} ${name}`);
    }
  }
  return `${[...lines, 'end_header'].join(lineEnd)}${lineEnd}`;
}

function asciiBody({ elements, lineEnd = '\n' }: Fixture): string {
  let text = '';
  for (const { count, properties } of elements) {
    for (let row = 0; row < count; row++) {
      const tokens = properties.flatMap(({ values }) => {
        const value = values[row];
        return typeof value === 'number' ? [value] : [value.length, ...value];
      });
      text += `${tokens.map((token) => (Object.is(token, -0) ? '-0' : String(token))).join(' ')}${lineEnd}`;
    }
  }
  return text;
}

function binaryBody({ format, elements }: Fixture): Uint8Array {
  const little = format === 'binary_little_endian';
  const bytes: number[] = [];
  for (const { count, properties } of elements) {
    for (let row = 0; row < count; row++) {
      for (const { type, countType, values } of properties) {
        const value = values[row];
        if (typeof value === 'number') bytes.push(...scalarBytes(type, value, little));
        else {
          bytes.push(...scalarBytes(countType ?? 'uchar', value.length, little));
          for (const item of value) bytes.push(...scalarBytes(type, item, little));
        }
      }
    }
  }
  return Uint8Array.from(bytes);
}

function scalarBytes(type: string, value: number, little: boolean): number[] {
  const make = ARRAYS[type];
  if (!make) throw new Error(`Unknown type ${type}.`);
  const bytes = [...new Uint8Array(make(value).buffer)];
  return little ? bytes : bytes.reverse();
}

const ARRAYS: Record<string, (value: number) => { buffer: ArrayBuffer }> = {
  char: (value) => Int8Array.of(value),
  uchar: (value) => Uint8Array.of(value),
  short: (value) => Int16Array.of(value),
  ushort: (value) => Uint16Array.of(value),
  int: (value) => Int32Array.of(value),
  uint: (value) => Uint32Array.of(value),
  float: (value) => Float32Array.of(value),
  double: (value) => Float64Array.of(value),
  int8: (value) => Int8Array.of(value),
  uint8: (value) => Uint8Array.of(value),
  int16: (value) => Int16Array.of(value),
  uint16: (value) => Uint16Array.of(value),
  int32: (value) => Int32Array.of(value),
  uint32: (value) => Uint32Array.of(value),
  float32: (value) => Float32Array.of(value),
  float64: (value) => Float64Array.of(value),
};
