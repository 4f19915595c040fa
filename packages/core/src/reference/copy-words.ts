/** Reference of copy-words. */
export function copyWords(words: Uint32Array): Uint32Array {
  return words.slice();
}
