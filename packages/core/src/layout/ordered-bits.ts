const f32 = new Float32Array(1);
const u32 = new Uint32Array(f32.buffer);

/** A number that grows with the float32 `value`, infinities included, and is above 0. Twin of lib/float-bits.wgsl. */
export function orderedBits(value: number): number {
  f32[0] = value;
  const [bits] = u32;
  return (bits >>> 31 === 1 ? ~bits : bits | 0x80000000) >>> 0;
}

/** The float32 of `orderedBits`. */
export function fromOrderedBits(ordered: number): number {
  u32[0] = ordered >>> 31 === 1 ? ordered & 0x7fffffff : ~ordered;
  return f32[0];
}
