import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import { type DecodedRows, rowLength } from '../rows/decoded-rows.ts';
import { FIRST_MODE, POSITION_STEPS } from './sog-layout.ts';
import type { SogMeta } from './sog-meta.ts';
import { labelsOf, paletteEntries, type SogUnit } from './sog-palette.ts';

/** Rotation component of each byte, from −√½ to √½. */
const COMPONENTS = Float64Array.from({ length: 256 }, (_, byte) => (byte / 255 - 0.5) * Math.SQRT2);

/** Writes consecutive splats: see `DecodedRows`. */
type Decode = DecodedRows['decode'];

/**
 * Returns a decoder for the splats of a SOG.
 *
 * @param shDegree degree of the rows, at least the file's; 0 for rows without harmonics.
 * @param origin origin to which row positions are relative.
 */
export function sogRows(unit: SogUnit, shDegree: ShDegree, origin: Vec3): Decode {
  const length = rowLength(shDegree);
  const putGeometry = geometryOf(unit, origin);
  const harmonics = shDegree > 0 ? unit.images.harmonics : null;
  const palette = harmonics && paletteEntries(unit);
  const labels = harmonics && labelsOf(unit);
  const coefficients = harmonics ? coefficientsPerSplat(harmonics.degree) : 0;
  let next = 0;
  return (rows, rowCount) => {
    for (let row = 0; row < rowCount * length; row += length, next++) {
      putGeometry(rows, row, next);
      let harmonic = row + ROW_SLOT.harmonics;
      if (palette && labels) {
        const from = labels[next] * coefficients;
        // Red, green and blue in one iteration are faster.
        for (let k = 0; k < coefficients; k += 3, harmonic += 3) {
          rows[harmonic] = palette[from + k];
          rows[harmonic + 1] = palette[from + k + 1];
          rows[harmonic + 2] = palette[from + k + 2];
        }
      }
      // The memory is reused and may contain old values.
      while (harmonic < row + length) rows[harmonic++] = 0;
    }
  };
}

/** As `sogRows`, with a palette index in place of each splat's harmonics. */
export function sogRowsOfPalette(unit: SogUnit, origin: Vec3): Decode {
  const length = ROW_SLOT.harmonics + 1;
  const putGeometry = geometryOf(unit, origin);
  const labels = labelsOf(unit);
  let next = 0;
  return (rows, rowCount) => {
    for (let row = 0; row < rowCount * length; row += length, next++) {
      putGeometry(rows, row, next);
      rows[row + ROW_SLOT.harmonics] = labels[next];
    }
  };
}

/**
 * Returns a function that writes a splat without its harmonics into the row at `row`.
 *
 * @param origin see `sogRows`.
 */
export function geometryOf(unit: SogUnit, origin: Vec3) {
  const { file, meta, images } = unit;
  const { positions, logScales, colors: colorValues } = meta;
  const { positionsLow, positionsHigh, rotations, scales, colors } = images;
  const [x, y, z] = positions.mins.map((min, axis) => new Axis(min, positions.maxs[axis], origin[axis]));
  const [scaleX, scaleY, scaleZ] = logScales;
  const [reds, greens, blues, logits] = colorValues;
  return (rows: Float32Array, row: number, splat: number): void => {
    const at = 4 * splat;
    const position = row + ROW_SLOT.position;
    rows[position] = x.at(positionsLow[at] | (positionsHigh[at] << 8));
    rows[position + 1] = y.at(positionsLow[at + 1] | (positionsHigh[at + 1] << 8));
    rows[position + 2] = z.at(positionsLow[at + 2] | (positionsHigh[at + 2] << 8));

    const logScale = row + ROW_SLOT.logScale;
    rows[logScale] = scaleX[scales[at]];
    rows[logScale + 1] = scaleY[scales[at + 1]];
    rows[logScale + 2] = scaleZ[scales[at + 2]];

    const mode = rotations[at + 3] - FIRST_MODE;
    if (mode < 0) throw modeError(file, splat, rotations[at + 3]);
    const a = COMPONENTS[rotations[at]];
    const b = COMPONENTS[rotations[at + 1]];
    const c = COMPONENTS[rotations[at + 2]];
    const rotation = row + ROW_SLOT.rotation;
    // The largest component is omitted and not negative; the others keep their order.
    rows[rotation] = a;
    rows[rotation + 1] = mode < 2 ? a : b;
    rows[rotation + 2] = mode < 3 ? b : c;
    rows[rotation + 3] = c;
    rows[rotation + mode] = Math.sqrt(Math.max(0, 1 - a * a - b * b - c * c));

    rows[row + ROW_SLOT.opacity] = logits[colors[at + 3]];
    const color = row + ROW_SLOT.colorDc;
    rows[color] = reds[colors[at]];
    rows[color + 1] = greens[colors[at + 1]];
    rows[color + 2] = blues[colors[at + 2]];
  };
}

/** Decoded coordinates of one axis, cached because many splats share a value. */
class Axis {
  readonly #min: number;
  readonly #step: number;
  readonly #origin: number;
  readonly #values = new Float32Array(POSITION_STEPS + 1).fill(Number.NaN);

  /**
   * @param min with `max`: the range of sign(v) ln(|v| + 1).
   * @param origin origin of decoded coordinates. Far from 0, float32 would be coarser than the
   *   file.
   */
  constructor(min: number, max: number, origin: number) {
    this.#min = min;
    this.#origin = origin;
    this.#step = (max - min) / POSITION_STEPS;
  }

  at(step: number): number {
    const value = this.#values[step];
    if (!Number.isNaN(value)) return value;
    this.#values[step] = coordinateOf(this.#min + this.#step * step) - this.#origin;
    return this.#values[step];
  }
}

/** Centre of the SOGs' bounding box if it lies far from 0; else 0, 0, 0. */
export function originOfSogs(metas: readonly SogMeta[]): Vec3 {
  const corners = metas.flatMap(({ positions: { mins, maxs } }) => [...mins, ...maxs]);
  return originOfSamples(Float64Array.from(corners, coordinateOf));
}

/** Inverse of sign(v) ln(|v| + 1). */
function coordinateOf(stored: number): number {
  return Math.sign(stored) * Math.expm1(Math.abs(stored));
}

function modeError(file: string, row: number, mode: number): SplatFileError {
  const message = `a rotation has the mode ${mode}; it must be ${FIRST_MODE} to 255. Export the scene again.`;
  return new SplatFileError('damaged', file, message, { row });
}
