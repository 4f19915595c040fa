import type { CompiledStage } from '../../gpu/pipelines.ts';
import type { CloudPage } from '../cloud-planes.ts';
import type { DispatchContext } from '../ingest/dispatches.ts';
import type { TouchedLinks } from './touched-links.ts';

/** A page of blobs, with the links of its slots. */
export interface BlobPage extends CloudPage {
  readonly links: GPUBuffer;
}

/** The levels of detail of a cloud on the GPU; frames draw cuts through them. */
export interface Levels {
  readonly cellCount: number;
  /** Cells of chunks of splats; they precede the cells of upper levels. */
  readonly chunkCells: number;
  readonly cells: GPUBuffer;
  /** Links of the splats, per page of the cloud. */
  readonly splatLinks: readonly GPUBuffer[];
  /**
   * One page of chunk blobs per page of the cloud, then one page for the leaves and blobs of all
   * upper levels.
   */
  readonly blobPages: readonly BlobPage[];
  /** Refines cuts around splats that are drawn one by one; null if no splat is. */
  readonly refinement: Refinement | null;
  readonly bytes: number;
  /** LOD of a cell, 0 for the finest. Chunks of a streamed leaf have the level of their leaf. */
  levelOf(cell: number): number;
  /**
   * Returns the cell below a leaf of a cell above the chunks; null if it is not on the GPU.
   *
   * @param slot slot of the leaf in its chunk.
   */
  childCell(cell: number, slot: number): number | null;
  destroy(): void;
}

export interface Refinement {
  /** Stages of the refinement. */
  readonly stages: readonly CompiledStage[];
  /**
   * Allocates links that refine the cuts of one view's frames; call `update` of the result before
   * each frame.
   */
  readonly make: (context: DispatchContext) => TouchedLinks;
}
