import { SplatFileError } from '../../../data/errors.ts';
import type { ByteReader } from '../../sources/byte-reader.ts';
import type { ReadProgress } from '../rows/progress.ts';
import type { SplatSetBuilder } from '../rows/splat-set-builder.ts';
import { clip, type PlyBody, type PlyElement, type PlyType } from './ply-header.ts';

/** Longest accepted line; a row of a real file has some hundred bytes. */
const MAX_LINE_BYTES = 1 << 24;

/** Unambiguous, to prevent catastrophic backtracking on megabytes of digits. */
const NUMBER = /^[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?$/;
/** NaN as C libraries print it, including old ones by Microsoft. */
const NOT_A_NUMBER = /^[+-]?(?:nan(?:\(\w*\))?|1\.#(?:qnan|snan|ind)0*)$/i;
const INFINITE = /^[+-]?(?:inf(?:inity)?|1\.#inf0*)$/i;

/** Reads a text body with one row per line, up to the last splat. Splats go to `builder`. */
export async function readAsciiRows(
  reader: ByteReader,
  body: PlyBody,
  builder: SplatSetBuilder,
  progress: ReadProgress,
): Promise<void> {
  const { elements, lineEnd, lineCount } = body.header;
  const vertex = elements[body.vertexIndex];
  // Rows without properties have no line.
  const rowsBefore = elements.slice(0, body.vertexIndex).reduce((sum, { count, properties }) => {
    return sum + (properties.length > 0 ? count : 0);
  }, 0);
  const parseRow = rowParser(body, vertex, builder.row);
  let row = -rowsBefore;
  let line = lineCount;
  while (row < vertex.count) {
    const text = await nextLines(reader, lineEnd, body.file, line + 1);
    if (text === undefined) {
      throw new SplatFileError(
        'truncated',
        body.file,
        `the file ends before its ${vertex.count} splats do. Download or export it again.`,
        { line, element: 'vertex', row: Math.max(0, row), byte: reader.byteOffset },
      );
    }
    for (const lineText of text.split(String.fromCharCode(lineEnd))) {
      line++;
      const trimmed = lineText.trim();
      if (trimmed === '') continue;
      if (row >= 0) {
        parseRow(trimmed, line, row);
        builder.push(row);
      }
      if (++row === vertex.count) break;
    }
    progress.report(builder.count);
    await builder.handOn();
  }
}

/**
 * All complete lines in the window, without the last line end. At the end of the file, the last
 * line may lack one; then undefined.
 */
async function nextLines(
  reader: ByteReader,
  lineEnd: number,
  file: string,
  line: number,
): Promise<string | undefined> {
  let scanned = 0;
  for (;;) {
    const held = window(reader);
    // A line may arrive in a thousand chunks, so only new bytes are searched.
    const length = scanned + held.subarray(scanned).lastIndexOf(lineEnd);
    if (length >= scanned) {
      reader.advance(length + 1);
      return decode(held.subarray(0, length));
    }
    scanned = held.length;
    if (held.length > MAX_LINE_BYTES) {
      const message = `a line of more than ${MAX_LINE_BYTES} bytes; the file is damaged or not text.`;
      throw new SplatFileError('bad-value', file, message, { line, byte: reader.byteOffset });
    }
    if (await reader.fill(held.length + 1)) continue;
    // `fill` may have moved the window.
    const last = window(reader);
    const text = last.length === 0 ? undefined : decode(last);
    reader.advance(last.length);
    return text;
  }
}

function window(reader: ByteReader): Uint8Array {
  return reader.bytes.subarray(reader.start, reader.start + reader.available);
}

function decode(bytes: Uint8Array): string {
  return new TextDecoder('latin1').decode(bytes);
}

type RowParser = (text: string, line: number, row: number) => void;

/** Returns a function that parses the needed values of a line into `target`. */
function rowParser(body: PlyBody, vertex: PlyElement, target: Float64Array): RowParser {
  const { properties } = vertex;
  return (text, line, row) => {
    const tokens = text.split(/\s+/);
    const fail = (message: string, property?: string): never => {
      throw new SplatFileError('bad-value', body.file, message, { line, element: 'vertex', row, property });
    };
    const numberAt = (token: number, property: string): number => {
      if (token >= tokens.length) fail(`the line ends before ${property}.`, property);
      const value = parseNumber(tokens[token]);
      return value ?? fail(`"${clip(tokens[token])}" is no number.`, property);
    };
    let next = 0;
    for (let i = 0; i < properties.length; i++) {
      const { name, type, countType } = properties[i];
      const value = numberAt(next++, name);
      if (countType !== undefined) {
        if (!Number.isInteger(value) || value < 0) fail(`a list of ${value} items.`, name);
        next += value;
      } else if (body.slots[i] >= 0) {
        target[body.slots[i]] = inType(value, type);
      }
    }
    if (next !== tokens.length) {
      fail(`the line has ${tokens.length} values where ${next} were expected.`);
    }
  };
}

/** Rounds a text value to the precision of its declared type. */
function inType(value: number, type: PlyType): number {
  return type === 'float32' ? Math.fround(value) : value;
}

/** Undefined if `text` is not a number. */
function parseNumber(text: string): number | undefined {
  if (NUMBER.test(text)) return Number(text);
  if (NOT_A_NUMBER.test(text)) return Number.NaN;
  if (INFINITE.test(text)) return text.startsWith('-') ? Number.NEGATIVE_INFINITY : Number.POSITIVE_INFINITY;
  return undefined;
}
