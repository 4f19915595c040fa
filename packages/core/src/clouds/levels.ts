import type { CompiledStage } from '../gpu/pipelines.ts';
import type { CloudPage } from './cloud-planes.ts';
import type { DispatchContext } from './ingest/dispatches.ts';
import type { TouchedLinks } from './touched-links.ts';

/** One page of blobs, with the links of its slots. */
export interface BlobPage extends CloudPage {
  readonly links: GPUBuffer;
}

/** The levels of detail of a cloud, on the GPU, as frames draw cuts through them. */
export interface Levels {
  readonly cellCount: number;
  /** Cells of chunks of splats, which come before those of upper levels. */
  readonly chunkCells: number;
  readonly cells: GPUBuffer;
  /** Links of the splats, by page of the cloud. */
  readonly splatLinks: readonly GPUBuffer[];
  /** Blobs of the chunks, by page of the cloud; then the leaves and blobs of all upper levels. */
  readonly blobPages: readonly BlobPage[];
  /** Refines cuts around splats that are drawn one by one; null where nothing does. */
  readonly refinement: Refinement | null;
  readonly bytes: number;
  /** Level of a cell; 0 for those of chunks of splats that are none of a coarser level. */
  levelOf(cell: number): number;
  /**
   * Returns the cell below a leaf of a cell above the chunks; null if it is not on the GPU.
   *
   * @param slot of the leaf, in its chunk.
   */
  childCell(cell: number, slot: number): number | null;
  destroy(): void;
}

export interface Refinement {
  /** The stages that it takes. */
  readonly stages: readonly CompiledStage[];
  /** Makes room for links that refine cuts in the frames of one view: call `update` of the result. */
  readonly make: (context: DispatchContext) => TouchedLinks;
}
