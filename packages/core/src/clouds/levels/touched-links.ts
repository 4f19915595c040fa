import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import type { GpuValues } from '../../data/layout/gpu-struct.ts';
import { MergeParameters } from '../../data/layout/level-structs.ts';
import type { Bindings } from '../../gpu/pipelines.ts';
import { touchLinks, touchUpperLinks } from '../../stages/cut/cut.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import { cellsOf } from './level-cells.ts';

/** Cells that the same stages process: cells of one page of the cloud, or of one upper level. */
export interface CellRange {
  readonly start: number;
  readonly end: number;
  /** Page of the cloud; null for a level above the chunks. */
  readonly page: number | null;
  readonly parameters: Omit<GpuValues<typeof MergeParameters.fields>, 'firstCell' | 'endCell'>;
}

/** Splats whose edits the levels of detail lack, as a bit per splat. */
export interface TouchedSplats {
  /**
   * `edited`: splats changed since the levels were made. `hidden`: edited splats that are hidden.
   */
  readonly edited: Uint32Array<ArrayBuffer>;
  readonly hidden: Uint32Array<ArrayBuffer>;
  /** Count of edited splats. */
  count: number;
  /** Incremented with every change of the bits. */
  version: number;
}

/** A cloud in a frame. */
interface ShownCloud {
  readonly instance: {
    readonly cloud: {
      readonly chunks: ArrayBuffer;
      readonly features: readonly { readonly touched?: Readonly<TouchedSplats> }[];
    };
  };
  readonly uses: readonly { readonly selectionVersion: number | undefined }[];
}

/** The properties of a cloud's levels needed to refine links. */
interface LinkedLevels {
  readonly cells: GPUBuffer;
  readonly splatLinks: readonly GPUBuffer[];
  readonly blobPages: readonly { readonly links: GPUBuffer; readonly chunkCount: number }[];
  readonly chunks: ArrayBuffer;
  readonly ranges: readonly CellRange[];
}

/** Stages that refine links and upper links. */
export const TOUCH_STAGES = [touchLinks, touchUpperLinks];

const MASK_BYTES = 4 * SHADER_CONSTANTS.MASK_WORDS;

/**
 * Copies of the links and cells of a cloud's levels, changed by touch-links. With them, a frame
 * draws edited and selected splats one by one, and bounds of cells enclose edited splats.
 */
export class TouchedLinks {
  readonly cells: GPUBuffer;
  readonly #context: DispatchContext;
  readonly #levels: LinkedLevels;
  readonly #copies = new Map<GPUBuffer, GPUBuffer>();
  /** Links of all upper levels; a dummy that no stage reads if there are none. */
  readonly #upperLinks: GPUBuffer;
  /** Per page of the cloud. */
  readonly #bits: readonly { readonly editedBits: GPUBuffer; readonly hiddenBits: GPUBuffer }[];
  /** State from which the links were last made; null before the first `update`. */
  #made: { readonly chunks: ArrayBuffer; readonly versions: string } | null = null;

  constructor({ memory: whole, ...context }: DispatchContext, levels: LinkedLevels) {
    const memory = whole.part();
    this.#context = { ...context, memory };
    this.#levels = levels;
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
    const buffer = (of: string, bytes: number) => memory.createBuffer(`frame touched ${of}`, bytes, usage);
    const { splatLinks, blobPages } = levels;
    for (const links of [...splatLinks, ...blobPages.map((page) => page.links)])
      this.#copies.set(links, buffer('links', links.size));
    const upper = blobPages.at(splatLinks.length);
    this.#upperLinks = upper ? this.of(upper.links) : buffer('links', splatLinks[0].size);
    this.#bits = splatLinks.map((_, i) => ({
      editedBits: buffer('edits', MASK_BYTES * blobPages[i].chunkCount),
      hiddenBits: buffer('hidden splats', MASK_BYTES * blobPages[i].chunkCount),
    }));
    this.cells = buffer('cells', levels.cells.size);
  }

  /** The copy of these links. */
  of(links: GPUBuffer): GPUBuffer {
    return this.#copies.get(links)!;
  }

  /**
   * Updates links and bounds for the current edits and selections; does nothing if these have not
   * changed.
   *
   * @param pages bindings per page of the cloud: `chunks`, and `selectedBits` if the frame draws
   *   selections.
   */
  update({ instance, uses }: ShownCloud, pages: readonly Bindings[]): void {
    const { chunks, features } = instance.cloud;
    const touched = features.find((feature) => feature.touched)?.touched;
    const versions = [touched?.version, ...uses.map((use) => use.selectionVersion)].join();
    if (this.#made?.chunks === chunks && this.#made.versions === versions) return;
    const { queue } = this.#context.device;
    const { splatLinks, blobPages, ranges } = this.#levels;
    const upperLinks = this.#upperLinks;
    if (this.#made?.chunks !== chunks) {
      // Cells must enclose blobs, which keep the old positions, and moved splats.
      const cells = cellsOf(new Float32Array(this.#levels.chunks), new Float32Array(chunks));
      queue.writeBuffer(this.cells, 0, cells);
    }
    this.#made = { chunks, versions };
    const { dispatchRow } = this.#context;
    const dispatches = new Dispatches(this.#context);
    for (const { start, end, page, parameters } of ranges) {
      const packed = MergeParameters.pack({ ...parameters, firstCell: start, endCell: end, dispatchRow });
      if (page === null) {
        dispatches.add(touchUpperLinks, packed, { upperLinks }, end - start);
        continue;
      }
      const { editedBits, hiddenBits } = this.#bits[page];
      if (touched) {
        const { edited, hidden } = touched;
        const first = SHADER_CONSTANTS.MASK_WORDS * start;
        const size = Math.min(editedBits.size / 4, edited.length - first);
        queue.writeBuffer(editedBits, 0, edited, first, size);
        queue.writeBuffer(hiddenBits, 0, hidden, first, size);
      }
      const links = { splatLinks: this.of(splatLinks[page]), blobLinks: this.of(blobPages[page].links) };
      // Without a selection, the edited bits are bound in its place, which adds no splats.
      const bits = { editedBits, hiddenBits, selectedBits: editedBits };
      dispatches.add(touchLinks, packed, { upperLinks, ...links, ...bits, ...pages[page] }, end - start);
    }
    dispatches.submit('touched links', (encoder) => {
      for (const [links, copy] of this.#copies) encoder.copyBufferToBuffer(links, 0, copy, 0, links.size);
    });
  }

  destroy(): void {
    this.#context.memory.destroyAll();
  }
}
