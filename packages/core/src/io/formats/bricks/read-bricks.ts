import { BrickShape } from '../../../data/bricks/brick-shape.ts';
import { SplatFileError } from '../../../data/errors.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import { Turns } from '../../../data/turns.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import type { ReadFormat, SplatFormatOptions, SplatInput } from '../read-format.ts';
import { type DecodedRows, deliverRows, rowLength } from '../rows/decoded-rows.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { readBrickHeader } from './brick-header.ts';
import { brickHeaderBytes, FILE_HEADER, FILE_HEADER_BYTES, mostBrickBytes } from './bricks-layout.ts';
import { type DecodedBrick, decodeBrick } from './decode-brick.ts';
import { type FileHeader, readFileHeader } from './file-header.ts';

/**
 * Reads the splats of a scene in bricks, without its levels of detail. A splat's row is its index
 * in the file.
 *
 * Rejects with `SplatFileError`: 'damaged', 'bad-header', 'truncated', 'too-large', 'empty'.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const header = readFileHeader(await input.reader.peek(FILE_HEADER_BYTES), input.name);
  const { splatCount, shDegree } = header;
  checkCount(splatCount, input.name, options.maxSplats, { byte: FILE_HEADER.splatCount });
  checkUnpacked(header, input, options);
  input.reader.advance(FILE_HEADER_BYTES);
  const splats = new BrickSplats(input, header);
  const rows: DecodedRows = {
    ...{ count: splatCount, shDegree, origin: header.origin },
    ...{ isAntialiased: header.isAntialiased, fileFacts: { format: 'bricks' } },
    arrive: (rowCount) => splats.arrive(rowCount),
    decode: (values, rowCount) => splats.decode(values, rowCount),
  };
  return deliverRows(rows, input, options, rowsTo);
};

/** Throws if the splats would take more memory than the limit for a file of this size. */
function checkUnpacked(
  { splatCount, shDegree }: FileHeader,
  input: SplatInput,
  { maxBytes }: SplatFormatOptions,
): void {
  const bytes = 4 * rowLength(shDegree) * splatCount;
  const limit = unpackedLimit({ maxBytes }, input);
  if (bytes <= limit) return;
  const message = `its ${splatCount} splats take ${bytes} bytes unpacked, and ${limit} are the limit. Pass a larger maxBytes if that is right.`;
  throw new SplatFileError('too-large', input.name, message, { byte: FILE_HEADER.splatCount });
}

/** Decodes the splats of a file in order, from the first brick of the lowest level. */
class BrickSplats {
  readonly #input: SplatInput;
  readonly #header: FileHeader;
  readonly #shape: BrickShape;
  /** An aborted load ends between two bricks. */
  readonly #turns = new Turns(undefined);
  #next = 0;
  /** Decoded bricks with splats left, and the number already taken from the first of them. */
  readonly #bricks: DecodedBrick[] = [];
  #taken = 0;
  #left = 0;

  constructor(input: SplatInput, header: FileHeader) {
    this.#input = input;
    this.#header = header;
    this.#shape = new BrickShape(header.splatCount);
  }

  /** Decodes bricks until this many splats are ready. Rejects with SplatFileError. */
  async arrive(count: number): Promise<void> {
    while (this.#left < count) await this.#readBrick();
  }

  /** Writes the next splats, which must be ready, as rows. */
  decode(rows: Float32Array, rowCount: number): void {
    const length = rowLength(this.#header.shDegree);
    const width = coefficientsPerSplat(this.#header.shDegree);
    for (let row = 0; row < rowCount; row++) {
      const { leaves, coefficients } = this.#bricks[0];
      const [i, at] = [this.#taken, row * length];
      for (let axis = 0; axis < 3; axis++) {
        rows[at + ROW_SLOT.position + axis] = leaves.positions[3 * i + axis];
        rows[at + ROW_SLOT.logScale + axis] = leaves.logScales[3 * i + axis];
        rows[at + ROW_SLOT.colorDc + axis] = leaves.colorDc[3 * i + axis];
      }
      for (let k = 0; k < 4; k++) rows[at + ROW_SLOT.rotation + k] = leaves.rotations[4 * i + k];
      rows[at + ROW_SLOT.opacity] = logitOf(leaves.opacities[i]);
      for (let k = 0; k < width; k++) rows[at + ROW_SLOT.harmonics + k] = coefficients[i * width + k];
      this.#taken++;
      if (this.#taken < leaves.count) continue;
      this.#bricks.shift();
      this.#taken = 0;
    }
    this.#left -= rowCount;
  }

  async #readBrick(): Promise<void> {
    const { name, reader } = this.#input;
    const number = this.#next++;
    const { level, first, end } = this.#shape.cellsOf(number);
    const headerBytes = brickHeaderBytes(level, end - first);
    const offset = reader.byteOffset;
    const bytes = await this.#bytes(headerBytes, number);
    const { geometryBytes, harmonicsBytes } = readBrickHeader(bytes, { number, offset }, this.#shape, name);
    const total = headerBytes + geometryBytes + harmonicsBytes;
    const { shDegree } = this.#header;
    if (total > mostBrickBytes(level, end - first, shDegree)) {
      const message = `brick ${number} has ${total} bytes, more than its splats take. Download or export it again.`;
      throw new SplatFileError('damaged', name, message, { byte: offset });
    }
    // Copied, because the reader reuses its memory.
    const whole = (await this.#bytes(total, number)).slice();
    reader.advance(total);
    if (level > 0) return;
    const address = { number, offset, bytes: total };
    const decoded = await decodeBrick(whole, address, this.#shape, shDegree, name, this.#turns);
    this.#bricks.push(decoded);
    this.#left += decoded.leaves.count;
  }

  /** The next bytes, without consuming them. */
  async #bytes(count: number, number: number): Promise<Uint8Array<ArrayBuffer>> {
    const { name, reader } = this.#input;
    if (!(await reader.fill(count))) {
      const byte = reader.byteOffset + reader.available;
      const message = `it ends within brick ${number} of ${this.#shape.brickCount}. Download or export it again.`;
      throw new SplatFileError('truncated', name, message, { byte });
    }
    return reader.bytes.subarray(reader.start, reader.start + count);
  }
}
