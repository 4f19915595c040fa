import { InvalidArgumentError } from '../errors.ts';
import { given, wrongArgument } from '../given.ts';

/** A grading of colours. Without options nothing changes. */
export interface GradeOptions {
  /** Stops, −10…10: each multiplies encoded colours by 2^(1/2.2), about twice the light; default 0. */
  readonly exposure?: number;
  /** 0 is grey, 1 no change, at most 4; default 1. */
  readonly saturation?: number;
  /** −1 is blue, 1 is orange; default 0. */
  readonly temperature?: number;
  /** −1 is green, 1 is magenta; default 0. */
  readonly tint?: number;
}

/** Shares of red, green and blue in the brightness of a colour (Rec. 709). */
const LUMA = [0.2126, 0.7152, 0.0722] as const;
/** Exponent between light and encoded values. */
const GAMMA = 2.2;
/** Stops by which the ends of temperature and tint change a channel before brightness is restored. */
const WHITE_STOPS = 0.5;

const RANGES = {
  exposure: [-10, 10],
  saturation: [0, 4],
  temperature: [-1, 1],
  tint: [-1, 1],
} as const;

/** @throws InvalidArgumentError that names the option out of range. */
export function checkGrade(options: GradeOptions): void {
  given(options, {}, 'grade');
  for (const [name, [min, max]] of Object.entries(RANGES)) {
    const value = options[name as keyof GradeOptions];
    if (value === undefined) continue;
    if (typeof value !== 'number' || !(value >= min && value <= max))
      throw wrongArgument(name, value, `a number of a grade, ${min}…${max}`);
  }
  const others = Object.keys(options).filter((name) => !(name in RANGES));
  if (others.length > 0)
    throw new InvalidArgumentError(
      others[0],
      `grade has no option ${others[0]}; it has ${Object.keys(RANGES).join(', ')}.`,
    );
}

/**
 * The grade as a matrix on sRGB-encoded red, green and blue, 3 × 3, row-major. White balance keeps
 * the brightness of greys.
 */
export function gradeMatrix({
  exposure = 0,
  saturation = 1,
  temperature = 0,
  tint = 0,
}: GradeOptions): Float64Array {
  const balance = [temperature, -tint, -temperature].map((value) => 2 ** ((WHITE_STOPS * value) / GAMMA));
  const brightness = balance.reduce((sum, gain, channel) => sum + gain * LUMA[channel], 0);
  const gains = balance.map((gain) => (2 ** (exposure / GAMMA) * gain) / brightness);
  return Float64Array.from({ length: 9 }, (_, i) => {
    const [row, column] = [Math.floor(i / 3), i % 3];
    return gains[row] * ((1 - saturation) * LUMA[column] + (row === column ? saturation : 0));
  });
}
