/** Reference of compact-chunks: numbers of the chunks whose flag is 1, in storage order. */
export function compactChunks(flags: ArrayLike<number>): number[] {
  return Array.from(flags).flatMap((flag, chunk) => (flag === 1 ? [chunk] : []));
}
