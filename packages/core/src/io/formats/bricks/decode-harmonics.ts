import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { COMPONENT_BYTES, HARMONICS_HEAD_BYTES, IS_DIFFERENCE, IS_WIDE } from './bricks-layout.ts';
import { PlaneReader, unzigzag } from './planes.ts';

/**
 * Reads what `encodeHarmonics` has written.
 *
 * Rejects with the reason of the turns' signal.
 *
 * @returns 3K coefficients for each of `count` leaves; null if the bytes are not as they are written.
 */
export async function decodeHarmonics(
  bytes: Uint8Array,
  degree: ShDegree,
  count: number,
  turns: Turns,
): Promise<Float32Array | null> {
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
  const axes = new Float64Array(components * width);
  const values = new Int32Array(components * count);
  const planes = new PlaneReader(bytes, count, headBytes);
  for (let component = 0; component < components; component++) {
    const at = firstComponent + component * componentBytes;
    const flags = head.getUint8(at);
    const length = head.getFloat32(at + 1, true);
    for (let k = 0; k < width; k++)
      axes[component * width + k] = length * head.getInt8(at + COMPONENT_BYTES + k);
    const isDifference = (flags & IS_DIFFERENCE) !== 0;
    const first = component * count;
    let value = 0;
    const take = (leaf: number, bits: number) => {
      value = unzigzag(bits) + (isDifference ? value : 0);
      values[first + leaf] = value;
    };
    if (flags & IS_WIDE) planes.wide(take);
    else planes.narrow(take);
  }
  const means = Float64Array.from({ length: width }, (_, k) =>
    head.getFloat32(HARMONICS_HEAD_BYTES + 4 * k, true),
  );
  const coefficients = new Float32Array(count * width);
  // Leaf by leaf, in half of the time that it takes component by component.
  const sums = new Float64Array(width);
  for (let leaf = 0; leaf < count; leaf++) {
    if (leaf % CHUNK_SPLATS === 0) await turns.give();
    sums.set(means);
    for (let component = 0; component < components; component++) {
      const value = values[component * count + leaf];
      if (value === 0) continue;
      const axis = component * width;
      for (let k = 0; k < width; k++) sums[k] += value * axes[axis + k];
    }
    coefficients.set(sums, leaf * width);
  }
  return coefficients.every(Number.isFinite) ? coefficients : null;
}
