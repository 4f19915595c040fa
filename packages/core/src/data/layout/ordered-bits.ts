const f32 = new Float32Array(1);
const u32 = new Uint32Array(f32.buffer);

/** The float32 whose ordered bits, as lib/float-bits.wgsl makes them, are `ordered`. */
export function fromOrderedBits(ordered: number): number {
  u32[0] = ordered >>> 31 === 1 ? ordered & 0x7fffffff : ~ordered;
  return f32[0];
}
