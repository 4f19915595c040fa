import { fromHalfBits } from '../../../data/layout/half.ts';
import { FLAT_LOG_SCALE, logScaleOf } from '../rows/flat-scale.ts';

/** Value encodings: see `decodeColumn`. */
export type Encoding =
  | ('f32' | 'f16' | 'f32_lebytes' | 'f16_lebytes')
  | ('r8' | 'r8_delta' | 's8' | 's8_delta')
  | ('ln_0r8' | 'ln_f16' | 'oct88r8' | 'u16' | 'u32');

const FLOATS = ['f32', 'f16'] as const;
const HARMONICS = [...FLOATS, 'r8', 'r8_delta', 's8', 's8_delta'] as const;

/** Properties of nodes, and of palette entries (`_code`): values per row, and allowed encodings. */
export const PROPERTIES = {
  center: { width: 3, encodings: [...FLOATS, 'f32_lebytes', 'f16_lebytes'] },
  alpha: { width: 1, encodings: [...FLOATS, 'r8'] },
  rgb: { width: 3, encodings: [...FLOATS, 'r8', 'r8_delta'] },
  scales: { width: 3, encodings: ['f32', 'ln_0r8', 'ln_f16'] },
  orientation: { width: 3, encodings: [...FLOATS, 'oct88r8'] },
  sh1: { width: 9, encodings: HARMONICS },
  sh2: { width: 15, encodings: HARMONICS },
  sh3: { width: 21, encodings: HARMONICS },
  sh1_code: { width: 9, encodings: HARMONICS },
  sh2_code: { width: 15, encodings: HARMONICS },
  sh3_code: { width: 21, encodings: HARMONICS },
  sh_label: { width: 1, encodings: ['u16', 'u32'] },
  child_count: { width: 1, encodings: ['u16'] },
  child_start: { width: 1, encodings: ['u32'] },
} as const satisfies Record<string, { width: number; encodings: readonly Encoding[] }>;

export type PropertyName = keyof typeof PROPERTIES;

const VALUE_BYTES: Readonly<Record<Encoding, number>> = {
  ...{ f32: 4, f16: 2, f32_lebytes: 4, f16_lebytes: 2 },
  ...{ r8: 1, r8_delta: 1, s8: 1, s8_delta: 1 },
  ...{ ln_0r8: 1, ln_f16: 2, oct88r8: 1, u16: 2, u32: 4 },
};

/** Bytes per row. */
export function bytesOf(name: PropertyName, encoding: Encoding): number {
  return PROPERTIES[name].width * VALUE_BYTES[encoding];
}

/** Largest magnitude of signed bytes: −127 to 127 encode −max to max. */
const SIGNED_MAX = 127;

/**
 * Decodes a little-endian column. It has the first values of all rows, then the second values, and
 * so on; `oct88r8` is row by row.
 *
 * - `_lebytes`: the lowest bytes of all values, then the next bytes
 * - `r8`: 0 to 255 from the lower to the upper bound
 * - `s8`: −127 to 127 times the upper bound / 127
 * - `_delta`: differences from the previous row, modulo 256
 * - `ln_0r8`: log scales; 1 to 255 from the lower to the upper bound, 0 for a scale of 0
 *
 * @param bytes bytes of `count` rows.
 * @param bound returns `min` or `max`; throws if it is missing.
 * @returns in file order: values; log scales; x, y, z, w; or integers.
 */
export function decodeColumn(
  name: PropertyName,
  encoding: Encoding,
  bytes: Uint8Array,
  count: number,
  bound: (key: 'min' | 'max') => number,
): Float32Array | Uint32Array {
  if (name === 'orientation') return orientations(encoding, bytes, count);
  const values = valuesOf(encoding, bytes, count, bound);
  return name === 'scales' && encoding === 'f32' ? values.map(logScaleOf) : values;
}

function valuesOf(
  encoding: Encoding,
  bytes: Uint8Array,
  count: number,
  bound: (key: 'min' | 'max') => number,
): Float32Array | Uint32Array {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const length = bytes.length / VALUE_BYTES[encoding];
  const filled = <Values extends Float32Array | Uint32Array>(
    values: Values,
    value: (i: number) => number,
  ) => {
    for (let i = 0; i < length; i++) values[i] = value(i);
    return values;
  };
  const floats = (value: (i: number) => number) => filled(new Float32Array(length), value);
  const words = (value: (i: number) => number) => filled(new Uint32Array(length), value);
  const ranged = (at: (i: number) => number) => {
    const [min, max] = [bound('min'), bound('max')];
    return floats((i) => min + (at(i) / 255) * (max - min));
  };
  const signed = (at: (i: number) => number) => {
    const max = bound('max');
    return floats((i) => (((at(i) << 24) >> 24) / SIGNED_MAX) * max);
  };
  switch (encoding) {
    case 'f32':
      return floats((i) => view.getFloat32(4 * i, true));
    case 'f16':
      return floats((i) => fromHalfBits(view.getUint16(2 * i, true)));
    case 'f32_lebytes': {
      const bits = words(
        (i) =>
          bytes[i] | (bytes[length + i] << 8) | (bytes[2 * length + i] << 16) | (bytes[3 * length + i] << 24),
      );
      return new Float32Array(bits.buffer);
    }
    case 'f16_lebytes':
      return floats((i) => fromHalfBits(bytes[i] | (bytes[length + i] << 8)));
    case 'r8':
      return ranged((i) => bytes[i]);
    case 'r8_delta':
      return ranged(summed(bytes, count));
    case 's8':
      return signed((i) => bytes[i]);
    case 's8_delta':
      return signed(summed(bytes, count));
    case 'ln_0r8': {
      const [min, max] = [bound('min'), bound('max')];
      return floats((i) => (bytes[i] === 0 ? FLAT_LOG_SCALE : min + ((bytes[i] - 1) / 254) * (max - min)));
    }
    case 'ln_f16':
      return floats((i) => {
        const value = fromHalfBits(view.getUint16(2 * i, true));
        return value === Number.NEGATIVE_INFINITY ? FLAT_LOG_SCALE : value;
      });
    case 'u16':
      return words((i) => view.getUint16(2 * i, true));
    case 'u32':
      return words((i) => view.getUint32(4 * i, true));
    case 'oct88r8':
      throw new RangeError('oct88r8 is an encoding of orientations');
  }
}

/** Running sums of byte differences; call the result with consecutive indices. */
function summed(bytes: Uint8Array, count: number): (i: number) => number {
  let sum = 0;
  return (i) => {
    sum = i % count === 0 ? bytes[i] : (sum + bytes[i]) & 0xff;
    return sum;
  };
}

/** x, y, z, w of `count` rows. */
function orientations(encoding: Encoding, bytes: Uint8Array, count: number): Float32Array {
  const quaternions = new Float32Array(4 * count);
  if (encoding === 'oct88r8') {
    for (let row = 0; row < count; row++) axisAndAngle(bytes, row, quaternions, count);
    return quaternions;
  }
  quaternions.set(valuesOf(encoding, bytes, count, () => Number.NaN));
  for (let row = 0; row < count; row++) {
    const [x, y, z] = [0, 1, 2].map((i) => quaternions[i * count + row]);
    // w is not negative.
    quaternions[3 * count + row] = Math.sqrt(Math.max(0, 1 - x * x - y * y - z * z));
  }
  return quaternions;
}

/** Two bytes for the axis, in octahedral coordinates, and one for the angle from 0 to π. */
function axisAndAngle(bytes: Uint8Array, row: number, quaternions: Float32Array, count: number): void {
  const u = (bytes[3 * row] / 255) * 2 - 1;
  const v = (bytes[3 * row + 1] / 255) * 2 - 1;
  const z = 1 - Math.abs(u) - Math.abs(v);
  const folded = Math.max(0, -z);
  const x = u >= 0 ? u - folded : u + folded;
  const y = v >= 0 ? v - folded : v + folded;
  const halfAngle = ((bytes[3 * row + 2] / 255) * Math.PI) / 2;
  const scale = Math.sin(halfAngle) / Math.hypot(x, y, z);
  quaternions[row] = x * scale;
  quaternions[count + row] = y * scale;
  quaternions[2 * count + row] = z * scale;
  quaternions[3 * count + row] = Math.cos(halfAngle);
}
