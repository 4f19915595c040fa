/** Chunks from which on placed ones are written, so that the caller sees the time that it takes. */
export const WRITTEN_AT_ONCE = 64;

/** Chunks of one page. */
export interface Chunks {
  readonly first: number;
  readonly count: number;
  /** The chunk after the last one of the page. */
  readonly pageEnd: number;
}

export interface JoinedChunks<Part> {
  readonly first: number;
  count: number;
  readonly parts: Part[];
}

/** Sorts ranges of chunks, and joins those that adjoin in the same page. */
export function joined<Part extends Chunks>(parts: readonly Part[]): readonly JoinedChunks<Part>[] {
  const all: JoinedChunks<Part>[] = [];
  for (const part of parts.toSorted((a, b) => a.first - b.first)) {
    const last = all.at(-1);
    if (last && last.first + last.count === part.first && part.first < last.parts[0].pageEnd) {
      last.count += part.count;
      last.parts.push(part);
    } else all.push({ first: part.first, count: part.count, parts: [part] });
  }
  return all;
}
