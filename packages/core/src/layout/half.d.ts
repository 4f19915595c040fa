/** Largest finite binary16 value. */
export declare const HALF_MAX = 65504;
/**
 * Bits of the binary16 nearest to `value`, ties to even; beyond ±65504 the bits of ±65504, so that packing never
 * makes an infinity. `value` is finite.
 */
export declare function toHalfBits(value: number): number;
/** Value of binary16 bits. */
export declare function fromHalfBits(bits: number): number;
