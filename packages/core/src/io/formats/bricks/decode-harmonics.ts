import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { COMPONENT_BYTES, HARMONICS_HEAD_BYTES, IS_DIFFERENCE, IS_WIDE } from './bricks-layout.ts';
import { PlaneReader, unzigzag } from './planes.ts';

/**
 * Decodes the output of `encodeHarmonics`.
 *
 * Rejects with the reason of the turns' signal.
 *
 * @returns 3K coefficients for each of `count` leaves; null if the bytes are malformed.
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
  // `factors`: per coefficient, its factor in each component. Next: per leaf, its value in each
  // component.
  const factors = new Float64Array(width * components);
  const values = new Float64Array(count * components);
  const planes = new PlaneReader(bytes, count, headBytes);
  for (let component = 0; component < components; component++) {
    const at = firstComponent + component * componentBytes;
    const flags = head.getUint8(at);
    const length = head.getFloat32(at + 1, true);
    for (let k = 0; k < width; k++)
      factors[k * components + component] = length * head.getInt8(at + COMPONENT_BYTES + k);
    const isDifference = (flags & IS_DIFFERENCE) !== 0;
    let value = 0;
    const take = (leaf: number, bits: number) => {
      value = unzigzag(bits) + (isDifference ? value : 0);
      values[leaf * components + component] = value;
    };
    if (flags & IS_WIDE) planes.wide(take);
    else planes.narrow(take);
  }
  const means = Float64Array.from({ length: width }, (_, k) =>
    head.getFloat32(HARMONICS_HEAD_BYTES + 4 * k, true),
  );
  const coefficients = new Float32Array(count * width);
  let areFinite = true;
  for (let start = 0; start < count; start += CHUNK_SPLATS) {
    await turns.give();
    const end = Math.min(start + CHUNK_SPLATS, count);
    areFinite = addComponents(coefficients, { means, factors, values }, start, end) && areFinite;
  }
  return areFinite ? coefficients : null;
}

interface Components {
  readonly means: Float64Array;
  readonly factors: Float64Array;
  readonly values: Float64Array;
}

/**
 * Writes the coefficients of the leaves from `start` to `end`. Most of a brick's decoding time is
 * spent here. Returns whether all are finite.
 */
function addComponents(
  coefficients: Float32Array,
  { means, factors, values }: Components,
  start: number,
  end: number,
): boolean {
  const width = means.length;
  const components = factors.length / width;
  // Becomes NaN if any coefficient is not finite.
  let zero = 0;
  // Two leaves and three channels at once take a third of the time, because they read less.
  for (let leaf = start; leaf < end; leaf += 2) {
    const a = leaf * components;
    // If their number is odd, the last leaf is written twice.
    const next = Math.min(leaf + 1, end - 1);
    const b = next * components;
    for (let k = 0; k < width; k += 3) {
      let [redA, greenA, blueA] = [means[k], means[k + 1], means[k + 2]];
      let [redB, greenB, blueB] = [redA, greenA, blueA];
      const red = k * components;
      const green = red + components;
      const blue = green + components;
      for (let i = 0; i < components; i++) {
        const [valueA, valueB] = [values[a + i], values[b + i]];
        redA += valueA * factors[red + i];
        redB += valueB * factors[red + i];
        greenA += valueA * factors[green + i];
        greenB += valueB * factors[green + i];
        blueA += valueA * factors[blue + i];
        blueB += valueB * factors[blue + i];
      }
      const atA = leaf * width + k;
      const atB = next * width + k;
      coefficients[atA] = redA;
      coefficients[atA + 1] = greenA;
      coefficients[atA + 2] = blueA;
      coefficients[atB] = redB;
      coefficients[atB + 1] = greenB;
      coefficients[atB + 2] = blueB;
      for (let channel = 0; channel < 3; channel++)
        zero += 0 * coefficients[atA + channel] + 0 * coefficients[atB + channel];
    }
  }
  return zero === 0;
}
