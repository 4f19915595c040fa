import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { CHUNK_LEVEL_BYTES, hasLevels, MISSING_LEVEL } from '../../gpu/effects/effect-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { FramePage } from '../frame-pages.ts';
import type { CloudShape } from '../plan/frame-shape.ts';

/** Chunks per cell above the first level: one of leaves and one of blobs. */
const UPPER_CHUNKS = 2;

/** Level of each chunk's splats or blobs, 4 bits per chunk, for effects that read it. */
export class ChunkLevels {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  #buffer: GPUBuffer | null = null;
  /** By page of the frame; null where no effect takes levels. */
  #pages: readonly (ChunksOfPage | null)[] = [];

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  /** Makes room for the levels of these clouds, and frees the rest. */
  fit(clouds: readonly CloudShape[], pages: readonly FramePage[]): void {
    this.#pages = pages.map((page) => {
      const { cloud, effects, levels } = clouds[page.cloudIndex];
      const before = pages.slice(0, pages.indexOf(page));
      const alike = before.filter(
        (each) =>
          each.cloudIndex === page.cloudIndex &&
          each.batchIndex === page.batchIndex &&
          each.isBlobs === page.isBlobs,
      );
      const firstCell = alike.reduce((sum, { chunksEach }) => sum + chunksEach, 0);
      return hasLevels(effects) ? { cloud, levels, page, firstCell } : null;
    });
    const bytes = this.#pages.some(Boolean) ? CHUNK_LEVEL_BYTES * pages.length : 0;
    if ((this.#buffer?.size ?? 0) === bytes) return;
    if (this.#buffer) this.#memory.destroy(this.#buffer);
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#buffer = bytes > 0 ? this.#memory.createBuffer('frame chunk levels', bytes, usage) : null;
  }

  /** Returns the binding of a page's stages, or null if they need none. */
  bindingOf(pageIndex: number): GPUBufferBinding | null {
    if (!this.#pages[pageIndex]) return null;
    return { buffer: this.#buffer!, offset: CHUNK_LEVEL_BYTES * pageIndex, size: CHUNK_LEVEL_BYTES };
  }

  /** Bytes of the levels of one cloud's chunks. */
  bytesOf(cloudIndex: number): number {
    return CHUNK_LEVEL_BYTES * this.#pages.filter((each) => each?.page.cloudIndex === cloudIndex).length;
  }

  /** Writes the levels of all present chunks: few bytes, and scenes that stream change often. */
  write(): void {
    for (const [i, page] of this.#pages.entries())
      if (page) this.#queue.writeBuffer(this.#buffer!, CHUNK_LEVEL_BYTES * i, packed(levelsOf(page)));
  }
}

/** Where the chunks of a page are among the cells of their cloud. */
interface ChunksOfPage {
  readonly cloud: SplatCloud;
  readonly levels: CloudShape['levels'];
  readonly page: FramePage;
  /** Cell of the page's first chunk, if its cells hold chunks of splats. */
  readonly firstCell: number;
}

function levelsOf({ cloud, levels, page, firstCell }: ChunksOfPage): number[] {
  if (!levels) return [];
  const lacking = cloud.stream?.lackingCells() ?? new Set();
  return Array.from({ length: page.chunksEach }, (_, chunk) => {
    const upper = firstCell + chunk - levels.chunkCells;
    const isUpper = upper >= 0;
    const cell = isUpper ? levels.chunkCells + Math.floor(upper / UPPER_CHUNKS) : firstCell + chunk;
    const standsForMissing = lacking.has(cell) && (isUpper ? upper % UPPER_CHUNKS === 0 : !page.isBlobs);
    if (standsForMissing) return MISSING_LEVEL;
    return Math.min(MISSING_LEVEL - 1, levels.levelOf(cell) + Number(page.isBlobs));
  });
}

function packed(levels: readonly number[]): Uint32Array<ArrayBuffer> {
  const words = new Uint32Array(Math.min(CHUNK_LEVEL_BYTES / 4, Math.ceil(levels.length / 8)));
  for (const [i, level] of levels.entries()) words[Math.floor(i / 8)] |= level << (4 * (i % 8));
  return words;
}
