/** Difference of one number of the GPU from its float64 reference. */
export interface FieldError<Field extends string = string> {
  readonly field: Field;
  /** Index of the splat's cloud in the frame, and of the splat in that cloud's storage order. */
  readonly cloudIndex: number;
  readonly splatIndex: number;
  readonly got: number;
  readonly expected: number;
  /** |got − expected|; NaN where `got` is. */
  readonly error: number;
  /** Largest permitted `error`, by derivation. Infinity where float32 promises nothing. */
  readonly bound: number;
  /** error / bound: above 1 is wrong. Infinity if `got` is not finite, or only the bound is 0. */
  readonly ratio: number;
}

/** Per field: the largest error relative to its bound, and the first error beyond its bound. */
export class FieldErrors<Field extends string> {
  readonly worst: Partial<Record<Field, FieldError<Field>>> = {};
  firstBad: FieldError<Field> | null = null;
  badCount = 0;

  add(
    place: Pick<FieldError, 'cloudIndex' | 'splatIndex'>,
    field: Field,
    got: number,
    expected: number,
    bound: number,
  ): void {
    const error = Math.abs(got - expected);
    const entry = { field, ...place, got, expected, error, bound, ratio: ratioOf(got, error, bound) };
    if (!(entry.ratio <= (this.worst[field]?.ratio ?? -1))) this.worst[field] = entry;
    if (entry.ratio <= 1) return;
    this.firstBad ??= entry;
    this.badCount++;
  }
}

function ratioOf(got: number, error: number, bound: number): number {
  if (error === 0) return 0;
  if (!Number.isFinite(got) || Number.isNaN(bound)) return Number.POSITIVE_INFINITY;
  return error / bound;
}

/** Describes an error in one line: place, field, value found and value expected. */
export function describeFieldError({
  field,
  cloudIndex,
  splatIndex,
  got,
  expected,
  bound,
}: FieldError): string {
  return `cloud ${cloudIndex}, splat ${splatIndex}, ${field}: got ${got}, expected ${expected} ± ${bound}`;
}
