import { checkCount } from '../rows/splat-counts.ts';
import type { SplatSetBuilder } from '../rows/splat-set-builder.ts';
import { type HarmonicsColumns, NodeRows, readPalette } from './node-rows.ts';
import type { RadChunk } from './rad-chunk.ts';
import type { RadHeader } from './rad-header.ts';
import { TreeCheck } from './tree-check.ts';

/** Splats between two yields to the event loop. */
const SPLATS_AT_ONCE = 4096;

/** Reads the splats of a scene: the nodes without children. */
export class FinestReader {
  readonly #header: RadHeader;
  readonly #builder: SplatSetBuilder;
  readonly #file: string;
  readonly #maxSplats: number;
  readonly #onSplats: () => Promise<void>;
  readonly #tree: TreeCheck;
  #palette: HarmonicsColumns | undefined;
  #count = 0;

  /**
   * @param builder receives the splats.
   * @param onSplats called after further splats were added.
   */
  constructor(
    header: RadHeader,
    builder: SplatSetBuilder,
    file: string,
    maxSplats: number,
    onSplats: () => Promise<void>,
  ) {
    this.#header = header;
    this.#builder = builder;
    this.#file = file;
    this.#maxSplats = maxSplats;
    this.#onSplats = onSplats;
    this.#tree = new TreeCheck(header.count, file);
  }

  /** Reads the next chunk. Rejects as `RadChunk.column`, and with SplatFileError 'too-large'. */
  async read(chunk: RadChunk, base: number, count: number): Promise<void> {
    const leaves = await this.#leavesOf(chunk, base, count);
    if (base === 0) this.#palette = await readPalette(chunk, this.#header);
    if (leaves.length === 0) return;
    this.#count += leaves.length;
    checkCount(this.#count, this.#file, this.#maxSplats);
    const rows = await NodeRows.read(chunk, count, this.#header.shDegree, this.#palette, this.#file);
    for (const [i, node] of leaves.entries()) {
      rows.fill(this.#builder.row, node);
      this.#builder.push(base + node);
      if ((i + 1) % SPLATS_AT_ONCE === 0) await this.#onSplats();
    }
    await this.#onSplats();
  }

  /** Called after the last chunk. @throws SplatFileError 'damaged' if the nodes form no tree. */
  finish(): void {
    if (this.#header.isTree) this.#tree.finish();
  }

  /** Indices within a chunk of its nodes without children. */
  async #leavesOf(chunk: RadChunk, base: number, count: number): Promise<Uint32Array> {
    const nodes = Uint32Array.from({ length: count }, (_, node) => node);
    if (!this.#header.isTree) return nodes;
    const childCounts = await chunk.column('child_count', count);
    const childStarts = await chunk.column('child_start', count);
    for (const node of nodes)
      if (childCounts[node] > 0) this.#tree.add(base + node, childStarts[node], childCounts[node]);
    return nodes.filter((node) => childCounts[node] === 0);
  }
}
