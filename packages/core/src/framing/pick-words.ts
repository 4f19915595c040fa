/**
 * Gathers the words of the splats at `slots`, in the order of `slots`; `stride` words per splat.
 */
export function pickWords(words: Uint32Array, stride: number, slots: Uint32Array): Uint32Array<ArrayBuffer> {
  const result = new Uint32Array(stride * slots.length);
  for (const [i, slot] of slots.entries())
    result.set(words.subarray(stride * slot, stride * (slot + 1)), stride * i);
  return result;
}
