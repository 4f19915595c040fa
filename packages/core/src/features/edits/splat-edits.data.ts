import { InvalidArgumentError } from '../../data/errors.ts';
import { given, wrongArgument } from '../../data/given.ts';
import { callListener } from '../../data/listeners.ts';
import { isFiniteF32 } from '../../data/math/float-step.ts';
import { isArrayOrTyped, isDetached, shown } from '../../data/printable.ts';
import { colorDcOf } from '../../data/splats/color-values.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';

/** Successive rows. */
export interface RowRange {
  /** Row of the first splat, from 0. */
  readonly first: number;
  /** Number of rows. */
  readonly count: number;
}

/** Rows of splats: a range, a list of indices, or the splats selected at the time of the call. */
export type EditedRows = RowRange | ArrayLike<number> | SplatSelection;

/**
 * New values of splats. Each array has values for every row, in the order of the rows, or for one
 * splat, whose values then apply to all rows. Properties that are missing stay unchanged.
 */
export interface EditedValues {
  /** Centres x, y, z in the cloud's own space. */
  readonly positions?: ArrayLike<number>;
  /** Standard deviations along the three local axes, above 0, in units of the cloud's own space. */
  readonly scales?: ArrayLike<number>;
  /** Quaternions x, y, z, w, of any length above 0. */
  readonly rotations?: ArrayLike<number>;
  /** Opacities at the splats' centres, 0…1. */
  readonly opacities?: ArrayLike<number>;
  /** Base colours r, g, b, sRGB-encoded, 0 black and 1 white. Harmonics above the base stay. */
  readonly colors?: ArrayLike<number>;
  /** Whether the splats are drawn. Hidden ones keep their opacity for later. */
  readonly visible?: boolean;
}

/** Columns of edits, as trained: log scales, quaternions w, x, y, z, coefficients of degree 0. */
type Column = Exclude<keyof EditedValues, 'visible'>;

/** Bits of a row's mask: one for each edited property. */
export const EDITED = {
  positions: 1,
  scales: 2,
  rotations: 4,
  opacities: 8,
  colors: 16,
  hidden: 32,
} as const;

const WIDTHS: Readonly<Record<Column, number>> = {
  positions: 3,
  scales: 3,
  rotations: 4,
  opacities: 1,
  colors: 3,
};
const COLUMNS = Object.keys(WIDTHS) as readonly Column[];

/** Values that each column takes, in words for messages. */
const DOMAINS: Readonly<Record<Column, { readonly what: string; readonly has: (value: number) => boolean }>> =
  {
    positions: { what: 'finite numbers that float32 holds', has: isFiniteF32 },
    scales: {
      what: 'standard deviations, finite numbers above 0',
      has: (x) => isFiniteF32(x) && x > 0,
    },
    rotations: { what: 'finite numbers that float32 holds', has: isFiniteF32 },
    opacities: { what: 'numbers from 0 to 1', has: (x) => isFiniteF32(x) && x >= 0 && x <= 1 },
    colors: { what: 'finite numbers that float32 holds', has: isFiniteF32 },
  };

/** Bits of a row's number that tell its place in its block. */
const BLOCK_BITS = 10;
/** Rows that lie in memory together, once one of them is edited. */
const BLOCK_ROWS = 1 << BLOCK_BITS;

/**
 * @internal Edits of successive rows: which columns of each are edited, and columns of values, null
 *   before the first edit.
 */
export class EditedBlock {
  /** Bits of `EDITED`. */
  readonly masks = new Uint8Array(BLOCK_ROWS);
  /** In float64, because they may be far from the origin. */
  positions: Float64Array | null = null;
  scales: Float32Array | null = null;
  rotations: Float32Array | null = null;
  opacities: Float32Array | null = null;
  colors: Float32Array | null = null;

  /** Makes room for a column. */
  make(column: Column): Float64Array | Float32Array {
    const length = WIDTHS[column] * BLOCK_ROWS;
    if (column !== 'positions') {
      this[column] = new Float32Array(length);
      return this[column];
    }
    this.positions = new Float64Array(length);
    return this.positions;
  }
}

/** @internal The place of a row in its block. */
export function placeInBlock(row: number): number {
  return row & (BLOCK_ROWS - 1);
}

type Writer = (to: Float64Array | Float32Array, at: number, values: ArrayLike<number>, from: number) => void;

/** Writes the values of one splat, from `from` on, as splats are trained. */
const WRITERS: Readonly<Record<Column, Writer>> = {
  positions: (to, at, values, from) => {
    for (let k = 0; k < 3; k++) to[at + k] = values[from + k];
  },
  scales: (to, at, values, from) => {
    for (let k = 0; k < 3; k++) to[at + k] = Math.log(values[from + k]);
  },
  rotations: (to, at, values, from) => {
    for (let k = 0; k < 4; k++) to[at + ((k + 1) & 3)] = values[from + k];
  },
  opacities: (to, at, values, from) => {
    to[at] = values[from];
  },
  colors: (to, at, values, from) => {
    for (let k = 0; k < 3; k++) to[at + k] = colorDcOf(values[from + k]);
  },
};

/** Is told of each change of `SplatEdits`. */
export interface EditsFollower {
  /** @param changed bits of `EDITED` that may have changed. */
  rowsChanged(rows: RowRange | Uint32Array, changed: number): void;
}

/** @throws InvalidArgumentError naming `name`, unless `values` are an array. `advice` follows. */
export function checkArray(name: string, values: unknown, advice = ''): asserts values is ArrayLike<number> {
  if (isArrayOrTyped(values)) return;
  throw new InvalidArgumentError(
    name,
    `${name} is ${shown(values)}; it must be an array of numbers.${advice}`,
  );
}

/**
 * Checks an array of values of splats.
 *
 * @param rows splats that it should have values for.
 * @throws InvalidArgumentError naming the array, the place and the value found.
 */
export function checkColumn(name: string, column: Column, values: ArrayLike<number>, rows: number): void {
  const width = WIDTHS[column];
  const { what, has } = DOMAINS[column];
  if (values.length !== width * rows) {
    const message = `${name} has ${shown(values.length)} values; ${rows} splats need ${width * rows}, ${width} each.`;
    throw new InvalidArgumentError(name, message);
  }
  for (let i = 0; i < values.length; i++) {
    if (has(values[i])) continue;
    const message = `${name}[${i}], of splat ${Math.floor(i / width)}, is ${shown(values[i])}; they are ${what}.`;
    throw new InvalidArgumentError(name, message);
  }
  if (column !== 'rotations') return;
  for (let i = 0; i < values.length; i += width) {
    if (values[i] || values[i + 1] || values[i + 2] || values[i + 3]) continue;
    const message = `${name}[${i}…${i + 3}], of splat ${i / width}, is 0; a quaternion has a length.`;
    throw new InvalidArgumentError(name, message);
  }
}

/**
 * Edits of splats by their rows: new positions, sizes, rotations, opacities and base colours, and
 * which rows are hidden. Rows count the splats of the source file or arrays.
 *
 * Edits are stored apart from the splats, 4 bytes a value and 8 a coordinate, and outlive clouds,
 * engines and devices. Clouds with these edits (`followEdits`) are drawn as edited from their next
 * frame on, even if they are uploaded later.
 *
 * @example
 * const edits = new SplatEdits();
 * await followEdits(cloud, edits);
 * edits.set([0, 3, 8], { colors: [1, 0, 0], opacities: [0.5] });
 * edits.set({ first: 100, count: 50 }, { visible: false });
 * edits.reset(); // as in the file again
 */
export class SplatEdits {
  /** Number of rows; rows 0 to `rowCount` − 1 can be edited. */
  readonly rowCount: number;
  readonly #blocks: (EditedBlock | undefined)[] = [];
  readonly #followers = new Set<EditsFollower>();
  #version = 0;
  #hasUnevenScales = false;

  /**
   * @param rowCount number of rows; edits of rows beyond it are refused. Default any: clouds ignore
   *   rows that they lack.
   */
  constructor(rowCount = 2 ** 31) {
    this.rowCount = rowCount;
  }

  /** Grows with every change. */
  get version(): number {
    return this.#version;
  }

  /** @internal Whether any edit has given a splat different sizes along its axes. */
  get hasUnevenScales(): boolean {
    return this.#hasUnevenScales;
  }

  /**
   * Gives rows new values. The clouds that follow upload the changed splats, and no others, before
   * their next frame.
   *
   * @throws InvalidArgumentError naming the row or the array, its index and the value; nothing
   *   changes then.
   */
  set(rows: EditedRows, values: EditedValues): void {
    const edited = this.#rowsOf(rows);
    const count = edited instanceof Uint32Array ? edited.length : edited.count;
    given(values, {}, 'values');
    const columns = COLUMNS.filter((column) => values[column] !== undefined);
    for (const column of columns) {
      checkArray(column, values[column]);
      const isForAll = values[column]!.length === WIDTHS[column];
      checkColumn(column, column, values[column]!, isForAll ? 1 : count);
    }
    const { visible } = values;
    if (visible !== undefined && typeof visible !== 'boolean')
      throw wrongArgument('visible', visible, 'true or false');
    let changed = visible === undefined ? 0 : EDITED.hidden;
    for (const column of columns) {
      this.#write(edited, count, column, values[column]!);
      changed |= EDITED[column];
    }
    if (visible !== undefined) this.#show(edited, count, visible);
    if (changed !== 0 && count > 0) this.#announce(edited, changed);
  }

  /** Restores rows as they are in the file or arrays; all rows by default. */
  reset(rows?: EditedRows): void {
    const all = Object.values(EDITED).reduce((sum, bit) => sum | bit, 0);
    const end = Math.min(this.rowCount, this.#blocks.length * BLOCK_ROWS);
    const restored = rows === undefined ? { first: 0, count: end } : this.#rowsOf(rows);
    const count = restored instanceof Uint32Array ? restored.length : restored.count;
    for (let i = 0; i < count; i++) {
      const row = restored instanceof Uint32Array ? restored[i] : restored.first + i;
      const block = this.blockOf(row);
      if (block) block.masks[placeInBlock(row)] = 0;
    }
    if (count > 0) this.#announce(restored, all);
  }

  /** @internal The block of a row, at `placeInBlock(row)`; undefined if unedited. */
  blockOf(row: number): EditedBlock | undefined {
    return this.#blocks[row >>> BLOCK_BITS];
  }

  /** The edited columns of a row as bits of `EDITED`; 0 for a row without edits. */
  maskOf(row: number): number {
    return this.blockOf(row)?.masks[placeInBlock(row)] ?? 0;
  }

  /** A row's edited values in a column, as trained. `maskOf(row)` must have the bit of `column`. */
  valuesOf(row: number, column: Column): Float64Array | Float32Array {
    const width = WIDTHS[column];
    const at = width * placeInBlock(row);
    return this.blockOf(row)![column]!.subarray(at, at + width);
  }

  /** Tells `follower` of each change from now on, until the result is called. */
  follow(follower: EditsFollower): () => void {
    this.#followers.add(follower);
    return () => this.#followers.delete(follower);
  }

  /** @internal Tells all followers that frames change, though no row does. */
  announceFrames(): void {
    this.#announce({ first: 0, count: 0 }, 0);
  }

  #announce(rows: RowRange | Uint32Array, changed: number): void {
    this.#version++;
    for (const follower of [...this.#followers])
      callListener((...change) => follower.rowsChanged(...change), rows, changed);
  }

  #write(rows: RowRange | Uint32Array, count: number, column: Column, values: ArrayLike<number>): void {
    const width = WIDTHS[column];
    const isForAll = values.length === width;
    const write = WRITERS[column];
    const bit = EDITED[column];
    for (let i = 0; i < count; i++) {
      const row = rows instanceof Uint32Array ? rows[i] : rows.first + i;
      const block = this.#madeBlockOf(row);
      const place = placeInBlock(row);
      block.masks[place] |= bit;
      write(block[column] ?? block.make(column), width * place, values, isForAll ? 0 : width * i);
    }
    if (column !== 'scales') return;
    for (let i = 0; i < values.length; i += 3)
      if (values[i] !== values[i + 1] || values[i] !== values[i + 2]) this.#hasUnevenScales = true;
  }

  #show(rows: RowRange | Uint32Array, count: number, isVisible: boolean): void {
    for (let i = 0; i < count; i++) {
      const row = rows instanceof Uint32Array ? rows[i] : rows.first + i;
      const { masks } = this.#madeBlockOf(row);
      if (isVisible) masks[placeInBlock(row)] &= ~EDITED.hidden;
      else masks[placeInBlock(row)] |= EDITED.hidden;
    }
  }

  #madeBlockOf(row: number): EditedBlock {
    const index = row >>> BLOCK_BITS;
    this.#blocks[index] ??= new EditedBlock();
    return this.#blocks[index];
  }

  #rowsOf(rows: EditedRows): RowRange | Uint32Array {
    const { rowCount } = this;
    const refuse = (what: string): never => {
      throw new InvalidArgumentError('rows', `${what}; rows are whole numbers from 0 to ${rowCount - 1}.`);
    };
    if (typeof rows !== 'object' || rows === null || isDetached(rows))
      return refuse(`rows is ${shown(rows)}`);
    if (rows instanceof SplatSelection) {
      const selected = rows.rows();
      const last = selected.at(-1) ?? 0;
      if (last >= rowCount) refuse(`Row ${last} is selected`);
      return selected;
    }
    if ('first' in rows) {
      const { first, count } = rows;
      const isRange = Number.isInteger(first) && Number.isInteger(count) && first >= 0 && count >= 0;
      if (!isRange || first + count > rowCount)
        refuse(`${shown(count)} rows from ${shown(first)} on cannot be edited`);
      return { first, count };
    }
    checkArray('rows', rows);
    for (let i = 0; i < rows.length; i++)
      if (!Number.isInteger(rows[i]) || rows[i] < 0 || rows[i] >= rowCount)
        refuse(`rows[${i}] is ${shown(rows[i])}`);
    return Uint32Array.from(rows);
  }
}
