// Elementary functions of float64 made of operations that every engine rounds alike (+, −, ·, /, √).
// Results are the same, bit for bit, on every machine. Engines and systems differ in the last digit
// of Math.exp, Math.log and Math.sin.

const LN2_HIGH = 0.6931471803691238;
const LN2_LOW = 1.9082149292705877e-10;
const INVERSE_LN2 = Math.LOG2E;
const LEAST_EXPONENT = -1022;

const float = new Float64Array(1);
const words = new Uint32Array(float.buffer);
/** Of the word with the exponent. */
const HIGH = new Uint8Array(new Uint16Array([1]).buffer)[0];

/** 2 to a whole power from −1022 to 1023. */
function powerOfTwo(exponent: number): number {
  words[HIGH] = (exponent + 1023) << 20;
  words[1 - HIGH] = 0;
  return float[0];
}

/** eˣ, to about 1e-15 of it; 0 where it would be less than 1e-307. */
export function exp(x: number): number {
  if (x > 709) return Number.POSITIVE_INFINITY;
  const power = Math.round(x * INVERSE_LN2);
  if (!(power >= LEAST_EXPONENT)) return 0;
  const rest = x - power * LN2_HIGH - power * LN2_LOW;
  let sum = 1;
  for (let k = 13; k > 0; k--) sum = 1 + (rest / k) * sum;
  return sum * powerOfTwo(power);
}

/** The natural logarithm of a normal number above 0, to about 1e-15. */
export function log(x: number): number {
  float[0] = x;
  let exponent = (words[HIGH] >>> 20) - 1023;
  words[HIGH] = (words[HIGH] & 0xfffff) | 0x3ff00000;
  let mantissa = float[0];
  if (mantissa > Math.SQRT2) {
    mantissa /= 2;
    exponent++;
  }
  const s = (mantissa - 1) / (mantissa + 1);
  const s2 = s * s;
  let sum = 0;
  for (let k = 19; k > 0; k -= 2) sum = 1 / k + s2 * sum;
  return exponent * LN2_HIGH + (exponent * LN2_LOW + 2 * s * sum);
}

/** Sine and cosine of an angle of at most some turns, in radians, to about 1e-14. */
export function sinCos(radians: number): readonly [sin: number, cos: number] {
  const quarter = Math.round(radians / (Math.PI / 2));
  const rest = radians - (quarter * Math.PI) / 2;
  const r2 = rest * rest;
  let sin = 1;
  let cos = 1;
  for (let k = 16; k > 0; k -= 2) {
    sin = 1 - (r2 / (k * (k + 1))) * sin;
    cos = 1 - (r2 / (k * (k - 1))) * cos;
  }
  sin *= rest;
  switch (((quarter % 4) + 4) % 4) {
    case 0:
      return [sin, cos];
    case 1:
      return [cos, -sin];
    case 2:
      return [-sin, -cos];
    default:
      return [-cos, sin];
  }
}
