import { MAX_FRAGMENT_ALPHA, maxColor } from '../data/accuracy/accuracy.ts';
import { HALF_MAX } from '../data/layout/half.ts';
import { readCoefficients } from '../data/packing/harmonics.ts';
import { coefficientsPerSplat } from '../data/splats/splat-set.ts';
import { screenAxes } from '../reference/covariance.ts';
import { stackedAlpha } from '../reference/stacked-opacity.ts';
import { type CulledSplat, cullSplat, type VisibleSplat } from '../stages/cull/cull.reference.ts';
import { splatColor } from '../stages/project/project.reference.ts';
import { FLOAT32_ROUNDING, type ProjectionErrors, projectionErrors } from './error-bounds.ts';
import { FieldErrors } from './field-error.ts';
import type { InspectedCloud, InspectedFrame } from './inspected-frame.ts';
import { type DecodedRecord, readRecords } from './read-records.ts';

/** Compared numbers of a record: lengths in px, Σ in px², alpha around its own centre. */
export const RECORD_FIELDS = [
  'centerPx.x',
  'centerPx.y',
  'depthView',
  'majorPx length',
  'minorLengthPx',
  'Σxx',
  'Σxy',
  'Σyy',
  'r',
  'g',
  'b',
  'opacity',
  'alpha at 0σ',
  'alpha at 1σ major',
  'alpha at 2σ major',
  'alpha at 1σ minor',
  'alpha at 2σ minor',
] as const;
/** Name of a value of a record that is compared. */
export type RecordField = (typeof RECORD_FIELDS)[number];

const u = FLOAT32_ROUNDING;
/** LONGEST_AXIS_PX of shaders/lib/covariance.wgsl: longer axes give the same image. */
const LONGEST_AXIS_PX = 1e18;
/** Middle of an image so wide that nothing lies outside of it. */
const MIDDLE_PX = 5e8;

/** Compares every record of the frame with its float64 reference; bounds: `compareRecord`. */
export async function compareRecords(frame: InspectedFrame): Promise<FieldErrors<RecordField>> {
  const errors = new FieldErrors<RecordField>();
  for (const record of await readRecords(frame)) compareRecord(frame, record, errors);
  return errors;
}

type Add = (field: RecordField, got: number, expected: number, bound: number) => void;

function compareRecord(frame: InspectedFrame, record: DecodedRecord, errors: FieldErrors<RecordField>): void {
  const { cloud, index } = frame.locate(record.splat);
  const place = { cloudIndex: frame.clouds.indexOf(cloud), splatIndex: index };
  const add: Add = (field, got, expected, bound) => errors.add(place, field, got, expected, bound);
  const reference = referenceOf(frame, cloud, index);
  // The GPU draws this splat and the reference does not: compare its opacity with 0.
  if (!reference) {
    add('opacity', record.color[3], 0, 0);
    return;
  }
  const bounds = projectionErrors(cloud.stored, index, cloud.view, frame.projection);
  const { centerPx } = frame.projection;
  // The middle is added to the reference's centre and taken off again, a rounding of float64 each.
  const middleError = 2 * MIDDLE_PX * 2 ** -53;
  for (const axis of [0, 1] as const) {
    const expected = reference.centerPx[axis] - MIDDLE_PX + centerPx[axis];
    add(
      axis === 0 ? 'centerPx.x' : 'centerPx.y',
      record.centerPx[axis],
      expected,
      bounds.centerPx[axis] + middleError,
    );
  }
  add('depthView', record.depthView, reference.depthView, bounds.depthView);
  const rounding = roundingOf(frame);
  compareShape(record, reference, bounds, rounding, add);
  compareColor(frame, record, cloud, index, reference, bounds, rounding, add);
  compareAlpha(record, reference, bounds, rounding, add);
}

/** The reference's record of a splat, culled or not: each splat that the GPU kept must match it. */
export function referenceOf(
  { projection }: InspectedFrame,
  { stored, view, effects, dilationPx2 }: InspectedCloud,
  index: number,
): CulledSplat | null {
  const everywhere = {
    ...projection,
    near: Number.NEGATIVE_INFINITY,
    far: Number.POSITIVE_INFINITY,
    widthPx: 2 * MIDDLE_PX,
    heightPx: 2 * MIDDLE_PX,
    centerPx: [MIDDLE_PX, MIDDLE_PX] as const,
  };
  const settings = { alphaCutoff: 1e-9, dilationPx2, effects };
  return cullSplat(stored, index, view, everywhere, settings);
}

/** Limits and rounding errors of storing a record at its precision. */
interface RecordRounding {
  /** Longest axis that can be stored, px. */
  readonly longestAxisPx: number;
  /** Error of an axis, relative to its length. */
  readonly axis: number;
  /** Error of a colour or an opacity. */
  readonly color: (value: number) => number;
}

/**
 * Rounding to binary16, which some hardware does by truncating, errs by 2^-10 of the value. A
 * colour also errs by half the smallest step. An axis is never shorter than 0.77 px; a component of
 * it below 2^-14 that is flushed to zero adds a tenth. Unorm8 rounds to the nearest of its steps,
 * half-way cases by an ulp of float32.
 */
function roundingOf({ accuracy: { recordPrecision } }: InspectedFrame): RecordRounding {
  switch (recordPrecision) {
    case 'f32':
      return { longestAxisPx: LONGEST_AXIS_PX, axis: 0, color: () => 0 };
    case 'f16':
      return { longestAxisPx: LONGEST_AXIS_PX, axis: 0, color: (value) => value * 2 ** -10 + 2 ** -24 };
    case 'paper':
      return { longestAxisPx: HALF_MAX, axis: 1.1 * 2 ** -10, color: () => 0.5 / 255 + u };
  }
}

/** Both lengths at √2 standard deviations, px. */
function referenceLengths({ covariance }: VisibleSplat): [major: number, minor: number] {
  const { majorPx, minorPx } = screenAxes(covariance);
  return [Math.hypot(...majorPx), Math.hypot(...minorPx)];
}

/**
 * Bound of a length's error: by Weyl a singular value moves no more than the matrix does; 16u for
 * sums and roots.
 */
function lengthBound(majorPx: number, { rowsPx }: ProjectionErrors): number {
  return Math.SQRT2 * rowsPx + 16 * u * majorPx;
}

/**
 * Axes may point either way, and anywhere for a circle, so this compares their lengths and the Σ
 * that they span, Σ = ½(major·majorᵀ + minor·minorᵀ). With B the rows and δ their error, |δΣ| ≤
 * 2|B|δ ≤ 2√(a+c)·δ, and 32u(a+c) for the operations after it. The minor length comes from a cross
 * product whose rounding is relative to both rows: equivalent to more error of the rows. Axes that
 * are then rounded by h of their lengths add 2h(a+c) to the first order.
 */
function compareShape(
  record: DecodedRecord,
  reference: VisibleSplat,
  bounds: ProjectionErrors,
  rounding: RecordRounding,
  add: Add,
): void {
  const { a, b, c } = reference.covariance;
  const [major, minor] = referenceLengths(reference);
  const { longestAxisPx, axis } = rounding;
  const shortened = (length: number) => Math.min(longestAxisPx, length);
  const bound = (length: number) => lengthBound(shortened(major), bounds) + axis * shortened(length);
  const [x, y] = record.majorPx;
  add('majorPx length', Math.hypot(x, y), shortened(major), bound(major));
  add('minorLengthPx', record.minorLengthPx, shortened(minor), bound(minor));

  const [minorX, minorY] = record.minorPx;
  const covarianceError =
    major >= longestAxisPx
      ? Number.POSITIVE_INFINITY
      : 2 * Math.sqrt(a + c) * bounds.rowsPx + (32 * u + 2 * axis * (1 + axis)) * (a + c);
  add('Σxx', (x * x + minorX * minorX) / 2, a, covarianceError);
  add('Σxy', (x * y + minorX * minorY) / 2, b, covarianceError);
  add('Σyy', (y * y + minorY * minorY) / 2, c, covarianceError);
}

/**
 * Basis functions are below 2.9 and change by less than 12 per unit of direction; sums of 16 terms.
 * Opacity is rounded once, after an `exp` on the CPU in float64 or as unorm16, and twice more when it
 * is multiplied by the cloud's opacity: 8u.
 */
function compareColor(
  frame: InspectedFrame,
  record: DecodedRecord,
  { stored, view, effects, shDegree }: InspectedCloud,
  index: number,
  reference: CulledSplat,
  { direction }: ProjectionErrors,
  rounding: RecordRounding,
  add: Add,
): void {
  const rest = new Float64Array(coefficientsPerSplat(3));
  readCoefficients(stored.harmonics, index, rest);
  const energy = rest
    .subarray(0, coefficientsPerSplat(shDegree))
    .reduce((sum, value) => sum + Math.abs(value), 0);
  const dc = Math.max(...stored.colorDc.subarray(3 * index, 3 * index + 3).map(Math.abs));
  const bound = 24 * u * (0.5 + dc + 2.9 * energy) + 12 * direction * energy;
  // Any larger value is the same colour, white.
  const most = maxColor(frame.accuracy);
  for (const [channel, value] of splatColor(stored, index, view, shDegree, reference, effects).entries()) {
    const expected = Math.min(most, value);
    add(
      (['r', 'g', 'b'] as const)[channel],
      record.color[channel],
      expected,
      bound + rounding.color(expected),
    );
  }
}

/**
 * Alpha of the record's Gaussian and of the reference's, both in float64, at k = 0, 1 and 2 of the
 * reference's standard deviations √λ along each axis e.
 *
 * Bound: the record is exact for rows with an error of δ = rowsPx + 16u√λ₁ (later arithmetic is
 * equivalent to more error of the rows). With E = Σ^-½ δΣ Σ^-½ the exponent's quadratic form is q' =
 * k² eᵀ(I + E)⁻¹e, so that |q' − q| ≤ k²(|eᵀEe| + |E|²/(1 − |E|)), where |eᵀEe| ≤ 2δ/√λ + (δ/√λ)²
 * and |E| ≤ 2δ/√λ₂ + (δ/√λ₂)². From there |α' − α| ≤ α·(e^(½|q' − q|) − 1), and no alpha is further
 * from another than the opacity. A needle so thin that rounding turns it away from its own axis
 * (|E| ≥ 1) has only that last bound.
 *
 * Axes A that are rounded by h of their lengths become A(I + D), |D| ≤ h·(√(λ₁/λ₂) + √(λ₂/λ₁)) in
 * units of the axes, and the exponent, |A⁻¹x|², changes by no more than the factor (1 − |D|)⁻².
 */
function compareAlpha(
  record: DecodedRecord,
  reference: VisibleSplat,
  bounds: ProjectionErrors,
  { longestAxisPx, axis: axisRounding, color }: RecordRounding,
  add: Add,
): void {
  const opacityError = 8 * u * Math.max(1, reference.opacity) + color(reference.opacity);
  add('opacity', record.color[3], reference.opacity, opacityError);
  const capped = (alpha: number) => Math.min(MAX_FRAGMENT_ALPHA, alpha);
  add('alpha at 0σ', capped(record.color[3]), capped(reference.opacity), opacityError);
  const { majorPx, minorPx } = screenAxes(reference.covariance);
  const lengths = referenceLengths(reference);
  // Such a record has shortened axes, so alphas along them cannot be compared; the lengths are.
  if (lengths[0] >= longestAxisPx) return;
  const [deviation1, deviation2] = lengths.map((length) => length / Math.SQRT2);
  const rowsError = bounds.rowsPx + 16 * u * deviation1;
  const relative = (deviation: number) => 2 * (rowsError / deviation) + (rowsError / deviation) ** 2;
  const largest = relative(deviation2);
  const turned = axisRounding * (lengths[0] / lengths[1] + lengths[1] / lengths[0]);
  const stretch = turned < 1 ? (1 - turned) ** -2 - 1 : Number.POSITIVE_INFINITY;
  const cross = largest < 1 ? largest ** 2 / (1 - largest) : Number.POSITIVE_INFINITY;
  for (const axis of ['major', 'minor'] as const) {
    const along = axis === 'major' ? majorPx : minorPx;
    const deviation = axis === 'major' ? deviation1 : deviation2;
    for (const k of [1, 2] as const) {
      const offsetPx = along.map((component) => (k * component) / Math.SQRT2);
      const alpha = stackedAlpha(reference.opacity, Math.exp(-0.5 * k * k));
      const unrounded = 0.5 * k * k * (relative(deviation) + cross);
      const exponentError = unrounded + (axisRounding > 0 ? stretch * (0.5 * k * k + unrounded) : 0);
      const bound = Math.min(reference.opacity, alpha * Math.expm1(exponentError)) + opacityError;
      add(`alpha at ${k}σ ${axis}`, capped(recordAlpha(record, offsetPx)), capped(alpha), bound);
    }
  }
}

/** Alpha of a record `offsetPx` from its centre, where its Gaussian is exp(−|p|²) by its axes. */
function recordAlpha({ majorPx, minorPx, color }: DecodedRecord, [x, y]: readonly number[]): number {
  const determinant = majorPx[0] * minorPx[1] - majorPx[1] * minorPx[0];
  const p = (x * minorPx[1] - y * minorPx[0]) / determinant;
  const q = (y * majorPx[0] - x * majorPx[1]) / determinant;
  return stackedAlpha(color[3], Math.exp(-p * p - q * q));
}
