import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import { roundUp } from '../../data/layout/gpu-struct.ts';
import { selectionsOf, takesSelection } from '../../gpu/effects/effect-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { FramePage } from '../frame-pages.ts';
import type { CloudPlan } from '../plan/cloud-plan.ts';
import type { CloudShape } from '../plan/frame-shape.ts';

/** Offsets of storage bindings are multiples of this many bytes. */
const STORAGE_ALIGNMENT = 256;

/** Position of one page's bits in the buffer. */
interface PageSlice {
  readonly cloud: SplatCloud;
  readonly cloudIndex: number;
  /** First splat of the page, counting through the cloud. */
  readonly splatStart: number;
  readonly splatCount: number;
  readonly byteOffset: number;
  /** How many selections have their bits there, one after another. */
  readonly selections: number;
  /** Of one selection. */
  readonly bytes: number;
}

/** One bit per splat and selection for the clouds of a frame whose effects take selections. */
export class SelectionBits {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  #buffer: GPUBuffer | null = null;
  /** By page of the frame; null for clouds whose effects take no selection. */
  #slices: readonly (PageSlice | null)[] = [];
  /** By cloud of the frame: the versions of the selections that the buffer holds, and of which rows. */
  readonly #written = new Map<number, { readonly versions: readonly number[]; readonly rows: number }>();

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  /** Makes room for the bits of these clouds; empty if none of their effects takes a selection. */
  fit(clouds: readonly CloudShape[], pages: readonly FramePage[]): void {
    const slices = slicesOf(clouds, pages);
    if (
      slices.length === this.#slices.length &&
      slices.every((each, i) => hasSameFields(each, this.#slices[i]))
    )
      return;
    if (this.#buffer) this.#memory.destroy(this.#buffer);
    this.#buffer = null;
    this.#written.clear();
    this.#slices = [];
    const bytes = Math.max(0, ...slices.map((slice) => (slice ? slice.byteOffset + sizeOf(slice) : 0)));
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
    if (bytes > 0) this.#buffer = this.#memory.createBuffer('frame selections', bytes, usage);
    this.#slices = slices;
  }

  /** Returns the binding of a page's stages, or null if they need none. */
  bindingOf(pageIndex: number): GPUBufferBinding | null {
    const slice = this.#slices[pageIndex];
    return slice && { buffer: this.#buffer!, offset: slice.byteOffset, size: sizeOf(slice) };
  }

  /** Bytes of one selection of a cloud. */
  bytesOf(cloudIndex: number): number {
    return this.#slices.reduce((sum, slice) => sum + (slice?.cloudIndex === cloudIndex ? slice.bytes : 0), 0);
  }

  /** Writes the selections that have changed since the last frame. */
  write(clouds: readonly CloudPlan[]): void {
    if (!this.#buffer) return;
    for (const [cloudIndex, { instance, uses }] of clouds.entries()) {
      const selections = uses.map(({ use }) => use.selection).filter((selection) => selection !== null);
      // In a pool, other splats take the place of splats.
      const { pool, version } = instance.cloud;
      const rowsVersion = pool ? version : 0;
      const last = this.#written.get(cloudIndex);
      const written = last?.rows === rowsVersion ? last.versions : [];
      for (const slice of this.#slices) {
        if (slice?.cloudIndex !== cloudIndex) continue;
        const { splatStart, splatCount, byteOffset, bytes } = slice;
        const rows = instance.cloud.fileIndices.subarray(splatStart, splatStart + splatCount);
        // Blobs, none of which stands for a selected splat: no bit of theirs is ever set.
        if (rows.length === 0) continue;
        for (const [i, selection] of selections.entries()) {
          if (written[i] === selection.version) continue;
          this.#queue.writeBuffer(this.#buffer, byteOffset + i * bytes, selection.bitsOf(rows));
        }
      }
      const versions = selections.map(({ version }) => version);
      this.#written.set(cloudIndex, { versions, rows: rowsVersion });
    }
  }
}

function slicesOf(clouds: readonly CloudShape[], pages: readonly FramePage[]): (PageSlice | null)[] {
  let byteOffset = 0;
  return pages.map(({ cloudIndex, splatStart, splatCount }) => {
    const { effects } = clouds[cloudIndex];
    if (!takesSelection(effects, ['splat', 'color'])) return null;
    const bytes = 4 * Math.ceil(splatCount / 32);
    const { cloud } = clouds[cloudIndex];
    const selections = selectionsOf(effects);
    const slice = { cloud, cloudIndex, splatStart, splatCount, byteOffset, selections, bytes };
    byteOffset = roundUp(byteOffset + sizeOf(slice), STORAGE_ALIGNMENT);
    return slice;
  });
}

function sizeOf({ selections, bytes }: PageSlice): number {
  return selections * bytes;
}
