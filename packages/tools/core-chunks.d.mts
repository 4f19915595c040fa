import type { Rolldown } from 'vite';

export const START: readonly string[];

export function coreChunk(
  folder: string,
  entries: Readonly<Record<string, string>>,
): (id: string, graph: Rolldown.ChunkingContext) => string | null;
