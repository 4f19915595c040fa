import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import type { GpuValues } from '../data/layout/gpu-struct.ts';
import { MergeParameters } from '../data/layout/level-structs.ts';
import type { Bindings } from '../gpu/pipelines.ts';
import { touchLinks, touchUpperLinks } from '../stages/cut/cut.ts';
import { type DispatchContext, Dispatches } from './ingest/dispatches.ts';
import { cellsOf } from './level-cells.ts';

/** Cells that the same stages take: those of a page of the cloud, or of an upper level. */
export interface CellRange {
  readonly start: number;
  readonly end: number;
  /** Page of the cloud; null for a level above the chunks. */
  readonly page: number | null;
  readonly parameters: Omit<GpuValues<typeof MergeParameters.fields>, 'firstCell' | 'endCell'>;
}

/** Splats that levels of detail do not show as edits have them: a bit per splat. */
export interface TouchedSplats {
  /** Changed since the levels were made; and those of them that are hidden. */
  readonly edited: Uint32Array<ArrayBuffer>;
  readonly hidden: Uint32Array<ArrayBuffer>;
  /** Number of edited ones. */
  count: number;
  /** Grows with every change of these. */
  version: number;
}

/** A cloud as a frame shows it. */
interface ShownCloud {
  readonly instance: {
    readonly cloud: {
      readonly chunks: ArrayBuffer;
      readonly editing: { readonly touched: TouchedSplats } | null;
    };
  };
  readonly uses: readonly { readonly selectionVersion: number | undefined }[];
}

/** The parts of a cloud's levels that links are refined by. */
interface LinkedLevels {
  readonly cells: GPUBuffer;
  readonly splatLinks: readonly GPUBuffer[];
  readonly blobPages: readonly { readonly links: GPUBuffer; readonly chunkCount: number }[];
  readonly chunks: ArrayBuffer;
  readonly ranges: readonly CellRange[];
}

/** All stages that make the links. */
export const TOUCH_STAGES = [touchLinks, touchUpperLinks];

const MASK_BYTES = 4 * SHADER_CONSTANTS.MASK_WORDS;

/**
 * Links of a cloud's levels by which a frame draws splats one by one that are edited or selected,
 * and cells with bounds that hold edited splats: copies, changed by touch-links.
 */
export class TouchedLinks {
  readonly cells: GPUBuffer;
  readonly #context: DispatchContext;
  readonly #levels: LinkedLevels;
  readonly #copies = new Map<GPUBuffer, GPUBuffer>();
  /** Of all levels above the chunks'; read by nothing where there is none. */
  readonly #upperLinks: GPUBuffer;
  /** By page of the cloud. */
  readonly #bits: readonly { readonly editedBits: GPUBuffer; readonly hiddenBits: GPUBuffer }[];
  /** What the links were made of; null: they hold nothing yet. */
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
   * Makes the links and bounds for what is edited now and selected, unless they are the same.
   *
   * @param pages of the cloud, with `chunks`, and with `selectedBits` where the frame shows selections.
   */
  update({ instance, uses }: ShownCloud, pages: readonly { readonly own: Bindings }[]): void {
    const { chunks, editing } = instance.cloud;
    const versions = [editing?.touched.version, ...uses.map((use) => use.selectionVersion)].join();
    if (this.#made?.chunks === chunks && this.#made.versions === versions) return;
    const { queue } = this.#context.device;
    const { splatLinks, blobPages, ranges } = this.#levels;
    const upperLinks = this.#upperLinks;
    if (this.#made?.chunks !== chunks) {
      // Blobs stay where splats were.
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
      if (editing) {
        const { edited, hidden } = editing.touched;
        const first = SHADER_CONSTANTS.MASK_WORDS * start;
        const size = Math.min(editedBits.size / 4, edited.length - first);
        queue.writeBuffer(editedBits, 0, edited, first, size);
        queue.writeBuffer(hiddenBits, 0, hidden, first, size);
      }
      const links = { splatLinks: this.of(splatLinks[page]), blobLinks: this.of(blobPages[page].links) };
      // A frame that shows no selection adds no splats.
      const bits = { editedBits, hiddenBits, selectedBits: editedBits };
      dispatches.add(touchLinks, packed, { upperLinks, ...links, ...bits, ...pages[page].own }, end - start);
    }
    dispatches.submit('touched links', (encoder) => {
      for (const [links, copy] of this.#copies) encoder.copyBufferToBuffer(links, 0, copy, 0, links.size);
    });
  }

  destroy(): void {
    this.#context.memory.destroyAll();
  }
}
