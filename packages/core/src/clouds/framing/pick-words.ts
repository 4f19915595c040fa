/** Copies the words of the splats that `slots` names, `stride` words each, in its order. */
export function pickWords(words: Uint32Array, stride: number, slots: Uint32Array): Uint32Array<ArrayBuffer> {
  const result = new Uint32Array(stride * slots.length);
  for (const [i, slot] of slots.entries())
    result.set(words.subarray(stride * slot, stride * (slot + 1)), stride * i);
  return result;
}
