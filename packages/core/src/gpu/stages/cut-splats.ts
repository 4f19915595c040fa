import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Tells which splats or blobs of a page's visible chunks the cut goes through. */
export const cutSplats: StageDefinition = {
  stage: 'cut-splats',
  source: levelSource('cut-splats'),
  entryPoint: 'cutSplats',
  constants: LEVEL_CONSTANTS,
};

/** Most workgroups for a page of so many chunks, all of which are visible. */
export function cutWorkgroups(chunkCount: number): number {
  return Math.ceil(chunkCount / 32);
}
