import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import { COMPONENT_BYTES, HARMONICS_HEAD_BYTES, IS_DIFFERENCE, IS_WIDE } from './bricks-layout.ts';
import { PlaneReader, unzigzag } from './planes.ts';

/**
 * Reads what `encodeHarmonics` has written.
 *
 * @returns 3K coefficients for each of `count` leaves; null if the bytes are not as they are written.
 */
export function decodeHarmonics(bytes: Uint8Array, degree: ShDegree, count: number): Float32Array | null {
  const width = coefficientsPerSplat(degree);
  const head = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const firstComponent = HARMONICS_HEAD_BYTES + 4 * width;
  if (bytes.length < firstComponent) return null;
  const components = head.getUint8(0);
  const componentBytes = COMPONENT_BYTES + width;
  const headBytes = firstComponent + components * componentBytes;
  if (components > width || bytes.length < headBytes) return null;
  let planeCount = 0;
  for (let at = firstComponent; at < headBytes; at += componentBytes)
    planeCount += head.getUint8(at) & IS_WIDE ? 2 : 1;
  if (bytes.length !== headBytes + planeCount * count) return null;
  const coefficients = new Float32Array(count * width);
  for (let k = 0; k < width; k++) {
    const mean = head.getFloat32(HARMONICS_HEAD_BYTES + 4 * k, true);
    for (let at = k; at < coefficients.length; at += width) coefficients[at] = mean;
  }
  const planes = new PlaneReader(bytes, count, headBytes);
  for (let at = firstComponent; at < headBytes; at += componentBytes) {
    const flags = head.getUint8(at);
    const length = head.getFloat32(at + 1, true);
    const axis = Float64Array.from(
      { length: width },
      (_, k) => length * head.getInt8(at + COMPONENT_BYTES + k),
    );
    const isDifference = (flags & IS_DIFFERENCE) !== 0;
    let value = 0;
    const add = (leaf: number, bits: number) => {
      value = unzigzag(bits) + (isDifference ? value : 0);
      if (value === 0) return;
      const first = leaf * width;
      for (let k = 0; k < width; k++) coefficients[first + k] += value * axis[k];
    };
    if (flags & IS_WIDE) planes.wide(add);
    else planes.narrow(add);
  }
  return coefficients.every(Number.isFinite) ? coefficients : null;
}

/** Bytes of the harmonics of so many leaves, unpacked, at most. */
export function mostHarmonicsBytes(degree: ShDegree, count: number): number {
  const width = coefficientsPerSplat(degree);
  return HARMONICS_HEAD_BYTES + 4 * width + width * (COMPONENT_BYTES + width + 2 * count);
}
