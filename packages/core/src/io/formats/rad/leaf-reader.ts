import { SplatFileError } from '../../../data/errors.ts';
import { colorDcOf, logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { checkCount } from '../check-count.ts';
import type { SplatSetBuilder } from '../splat-set-builder.ts';
import type { RadChunk } from './rad-chunk.ts';
import type { RadHeader } from './rad-header.ts';
import { TreeCheck } from './tree-check.ts';

/** Splats between two chances of a page's thread to do something else. */
const SPLATS_AT_ONCE = 4096;

/** Harmonics by degree: of nodes, and of the entries of a palette. */
const OWN_HARMONICS = ['sh1', 'sh2', 'sh3'] as const;
const PALETTE_HARMONICS = ['sh1_code', 'sh2_code', 'sh3_code'] as const;

/** Where each degree's coefficients begin, behind those of the ones below. */
const DEGREE_STARTS = [0, 9, 24];

/** Harmonics of `rowCount` rows: of each degree a column. */
interface HarmonicsColumns {
  readonly rowCount: number;
  readonly degrees: readonly (Float32Array | Uint32Array)[];
}

/** Reads the splats of a scene: nodes without children. */
export class LeafReader {
  readonly #header: RadHeader;
  readonly #builder: SplatSetBuilder;
  readonly #file: string;
  readonly #maxSplats: number;
  readonly #onSplats: () => Promise<void>;
  readonly #tree: TreeCheck;
  #palette: HarmonicsColumns | undefined;
  #count = 0;

  /**
   * @param builder takes the splats.
   * @param onSplats called when it has some more.
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
    const { shDegree, paletteSize } = this.#header;
    const leaves = await this.#leavesOf(chunk, base, count);
    // The first chunk has the palette of all.
    if (base === 0 && paletteSize !== undefined)
      this.#palette = await harmonicsOf(chunk, PALETTE_HARMONICS, shDegree, paletteSize);
    if (leaves.length === 0) return;
    this.#count += leaves.length;
    checkCount(this.#count, this.#file, this.#maxSplats);
    const centers = await chunk.column('center', count);
    const alphas = await chunk.column('alpha', count);
    const colors = await chunk.column('rgb', count);
    const logScales = await chunk.column('scales', count);
    const rotations = await chunk.column('orientation', count);
    const palette = shDegree > 0 ? this.#palette : undefined;
    const entries = palette && (await this.#labelsOf(chunk, count, palette.rowCount));
    const harmonics = palette ?? (await harmonicsOf(chunk, OWN_HARMONICS, shDegree, count));
    const { row } = this.#builder;
    for (const [i, node] of leaves.entries()) {
      for (let k = 0; k < 3; k++) {
        const at = k * count + node;
        row[ROW_SLOT.position + k] = centers[at];
        row[ROW_SLOT.logScale + k] = logScales[at];
        row[ROW_SLOT.colorDc + k] = colorDcOf(colors[at]);
        // x, y, z behind w.
        row[ROW_SLOT.rotation + 1 + k] = rotations[at];
      }
      row[ROW_SLOT.rotation] = rotations[3 * count + node];
      // Above 1, where blobs stand for several splats, leaves are but rounded.
      row[ROW_SLOT.opacity] = logitOf(Math.min(1, alphas[node]));
      const entry = entries ? entries[node] : node;
      for (const [degree, column] of harmonics.degrees.entries()) {
        const start = ROW_SLOT.harmonics + DEGREE_STARTS[degree];
        const width = column.length / harmonics.rowCount;
        for (let k = 0; k < width; k++) row[start + k] = column[k * harmonics.rowCount + entry];
      }
      this.#builder.push(base + node);
      if ((i + 1) % SPLATS_AT_ONCE === 0) await this.#onSplats();
    }
    await this.#onSplats();
  }

  /** Called after the last chunk. @throws SplatFileError 'damaged' for a tree that is none */
  finish(): void {
    if (this.#header.isTree) this.#tree.finish();
  }

  /** Places in a chunk of its nodes without children. */
  async #leavesOf(chunk: RadChunk, base: number, count: number): Promise<Uint32Array> {
    const nodes = Uint32Array.from({ length: count }, (_, node) => node);
    if (!this.#header.isTree) return nodes;
    const childCounts = await chunk.column('child_count', count);
    const childStarts = await chunk.column('child_start', count);
    for (const node of nodes)
      if (childCounts[node] > 0) this.#tree.add(base + node, childStarts[node], childCounts[node]);
    return nodes.filter((node) => childCounts[node] === 0);
  }

  async #labelsOf(chunk: RadChunk, count: number, entryCount: number): Promise<Float32Array | Uint32Array> {
    const labels = await chunk.column('sh_label', count);
    const wrong = labels.find((label) => label >= entryCount);
    if (wrong === undefined) return labels;
    const message = `a node has the harmonics ${wrong} of ${entryCount}. Export it again.`;
    throw new SplatFileError('damaged', this.#file, message, { property: 'sh_label' });
  }
}

async function harmonicsOf(
  chunk: RadChunk,
  names: typeof OWN_HARMONICS | typeof PALETTE_HARMONICS,
  shDegree: number,
  rowCount: number,
): Promise<HarmonicsColumns> {
  const degrees: (Float32Array | Uint32Array)[] = [];
  for (const name of names.slice(0, shDegree)) degrees.push(await chunk.column(name, rowCount));
  return { rowCount, degrees };
}
