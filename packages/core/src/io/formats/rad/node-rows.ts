import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { colorDcOf, logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import type { RadChunk } from './rad-chunk.ts';
import type { RadHeader } from './rad-header.ts';

/** Harmonics properties by degree: first of nodes, then of palette entries. */
const OWN_HARMONICS = ['sh1', 'sh2', 'sh3'] as const;
const PALETTE_HARMONICS = ['sh1_code', 'sh2_code', 'sh3_code'] as const;
/** Index of each degree's first coefficient. */
const DEGREE_STARTS = [0, 9, 24];

type Column = Float32Array | Uint32Array;

/** Harmonics of `rowCount` rows, one column per degree. */
export interface HarmonicsColumns {
  readonly rowCount: number;
  readonly degrees: readonly Column[];
}

/** The palette of the scene, from the first chunk; undefined if nodes have separate harmonics. */
export async function readPalette(
  chunk: RadChunk,
  { shDegree, paletteSize }: Pick<RadHeader, 'shDegree' | 'paletteSize'>,
): Promise<HarmonicsColumns | undefined> {
  return paletteSize === undefined ? undefined : harmonicsOf(chunk, PALETTE_HARMONICS, shDegree, paletteSize);
}

/** The nodes of a chunk, as splat rows. */
export class NodeRows {
  readonly #count: number;
  readonly #centers: Column;
  readonly #alphas: Column;
  readonly #colors: Column;
  readonly #logScales: Column;
  readonly #rotations: Column;
  /** Palette index per node; undefined if there is no palette. */
  readonly #labels: Column | undefined;
  readonly #harmonics: HarmonicsColumns;

  private constructor(
    count: number,
    columns: readonly Column[],
    labels: Column | undefined,
    harmonics: HarmonicsColumns,
  ) {
    this.#count = count;
    [this.#centers, this.#alphas, this.#colors, this.#logScales, this.#rotations] = columns;
    this.#labels = labels;
    this.#harmonics = harmonics;
  }

  /**
   * Decodes the nodes of a chunk. Rejects as `RadChunk.column`, and with SplatFileError 'damaged'.
   *
   * @param palette result of `readPalette`.
   */
  static async read(
    chunk: RadChunk,
    count: number,
    shDegree: number,
    palette: HarmonicsColumns | undefined,
    file: string,
  ): Promise<NodeRows> {
    const columns: Column[] = [];
    for (const name of ['center', 'alpha', 'rgb', 'scales', 'orientation'] as const)
      columns.push(await chunk.column(name, count));
    if (!palette || shDegree === 0)
      return new NodeRows(
        count,
        columns,
        undefined,
        await harmonicsOf(chunk, OWN_HARMONICS, shDegree, count),
      );
    const labels = await chunk.column('sh_label', count);
    const wrong = labels.find((label) => label >= palette.rowCount);
    if (wrong === undefined) return new NodeRows(count, columns, labels, palette);
    const message = `a node has the harmonics ${wrong} of ${palette.rowCount}. Export it again.`;
    throw new SplatFileError('damaged', file, message, { property: 'sh_label' });
  }

  get bytes(): number {
    const geometry = [this.#centers, this.#alphas, this.#colors, this.#logScales, this.#rotations];
    const own = [...geometry, ...(this.#labels ? [this.#labels] : this.#harmonics.degrees)];
    return own.reduce((sum, { byteLength }) => sum + byteLength, 0);
  }

  /** Centres of all nodes: x, y, z of each. */
  get centers(): Float64Array {
    return Float64Array.from({ length: 3 * this.#count }, (_, i) => this.center(Math.floor(i / 3), i % 3));
  }

  /** Makes positions relative to an origin; the file has float32 coordinates. */
  moveTo(origin: Vec3): void {
    for (let axis = 0; axis < 3; axis++)
      for (let i = axis * this.#count; i < (axis + 1) * this.#count; i++) this.#centers[i] -= origin[axis];
  }

  /** A coordinate of a node's centre. */
  center(node: number, axis: number): number {
    return this.#centers[axis * this.#count + node];
  }

  /** Opacity of a node as stored; may exceed 1. */
  alpha(node: number): number {
    return this.#alphas[node];
  }

  largestScale(node: number): number {
    const [x, y, z] = [0, 1, 2].map((axis) => this.#logScales[axis * this.#count + node]);
    return Math.exp(Math.max(x, y, z));
  }

  /** Writes a node into `row`, its opacity clamped to 1. */
  fill(row: Float64Array, node: number): void {
    const count = this.#count;
    for (let k = 0; k < 3; k++) {
      const at = k * count + node;
      row[ROW_SLOT.position + k] = this.#centers[at];
      row[ROW_SLOT.logScale + k] = this.#logScales[at];
      row[ROW_SLOT.colorDc + k] = colorDcOf(this.#colors[at]);
      // x, y, z follow w.
      row[ROW_SLOT.rotation + 1 + k] = this.#rotations[at];
    }
    row[ROW_SLOT.rotation] = this.#rotations[3 * count + node];
    row[ROW_SLOT.opacity] = logitOf(Math.min(1, this.#alphas[node]));
    const { rowCount, degrees } = this.#harmonics;
    const entry = this.#labels ? this.#labels[node] : node;
    for (const [degree, column] of degrees.entries()) {
      const start = ROW_SLOT.harmonics + DEGREE_STARTS[degree];
      const width = column.length / rowCount;
      for (let k = 0; k < width; k++) row[start + k] = column[k * rowCount + entry];
    }
  }
}

async function harmonicsOf(
  chunk: RadChunk,
  names: typeof OWN_HARMONICS | typeof PALETTE_HARMONICS,
  shDegree: number,
  rowCount: number,
): Promise<HarmonicsColumns> {
  const degrees: Column[] = [];
  for (const name of names.slice(0, shDegree)) degrees.push(await chunk.column(name, rowCount));
  return { rowCount, degrees };
}
