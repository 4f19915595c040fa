import { SplatFileError, type SplatFileErrorCode } from '../../../data/errors.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { ByteReader } from '../../sources/byte-reader.ts';
import { leftOutBands } from '../rows/left-out-bands.ts';

export type PlyFormat = 'ascii' | 'binary_little_endian' | 'binary_big_endian';
export type PlyType =
  | 'int8'
  | 'uint8'
  | 'int16'
  | 'uint16'
  | 'int32'
  | 'uint32'
  | 'float16'
  | 'float32'
  | 'float64';

export interface PlyProperty {
  readonly name: string;
  /** Type of the value, or of the items of a list. */
  readonly type: PlyType;
  /** Type of a list's length; undefined for scalars. */
  readonly countType: PlyType | undefined;
}

export interface PlyElement {
  readonly name: string;
  /** Number of rows, according to the header. */
  readonly count: number;
  readonly properties: readonly PlyProperty[];
}

export interface PlyHeader {
  readonly format: PlyFormat;
  /** In the order of their rows in the body. */
  readonly elements: readonly PlyElement[];
  /** Whether training had an antialias filter, according to comments; undefined if none says so. */
  readonly isAntialiased: boolean | undefined;
  /** Whether a comment says that colours are spherical harmonics. */
  readonly namesHarmonics: boolean;
  /** Name of the writing program, from a comment; undefined if there is none. */
  readonly writer: string | undefined;
  /** Number of lines, to continue the numbering in a text body. */
  readonly lineCount: number;
  /** The byte that ends a line: LF (also in CR LF), or CR in old files. */
  readonly lineEnd: number;
}

/** Facts about the body, for its readers. */
export interface PlyBody {
  readonly file: string;
  readonly header: PlyHeader;
  /** Index in `header.elements` of the element with the splats. */
  readonly vertexIndex: number;
  /** Builder slot of each property of that element; -1 for unused properties. */
  readonly slots: readonly number[];
}

export const TYPE_BYTES: Readonly<Record<PlyType, number>> = {
  int8: 1,
  uint8: 1,
  int16: 2,
  uint16: 2,
  int32: 4,
  uint32: 4,
  float16: 2,
  float32: 4,
  float64: 8,
};

const TYPES = new Map<string, PlyType>([
  ...(Object.keys(TYPE_BYTES) as PlyType[]).map((type): [string, PlyType] => [type, type]),
  ['char', 'int8'],
  ['uchar', 'uint8'],
  ['short', 'int16'],
  ['ushort', 'uint16'],
  ['int', 'int32'],
  ['uint', 'uint32'],
  ['half', 'float16'],
  ['float', 'float32'],
  ['double', 'float64'],
]);

const FORMATS: readonly string[] = [
  'ascii',
  'binary_little_endian',
  'binary_big_endian',
] satisfies PlyFormat[];

/** Far above any real header, and small enough to read. */
const MAX_HEADER_BYTES = 1 << 20;
const LF = 10;
const CR = 13;

/** Reads up to the first byte of the body. @throws SplatFileError 'bad-header', 'bad-property' */
export async function readPlyHeader(reader: ByteReader, file: string): Promise<PlyHeader> {
  const parser = new HeaderParser(file);
  const headerStart = reader.byteOffset;
  let lineEnd = LF;
  let scanned = 0;
  for (;;) {
    const { length, ended } = await findLineEnd(
      reader,
      parser.lineCount === 0 ? [LF, CR] : [lineEnd],
      scanned,
    );
    if (!ended || reader.byteOffset - headerStart + length > MAX_HEADER_BYTES) {
      const where =
        ended || length >= MAX_HEADER_BYTES
          ? `in the first ${MAX_HEADER_BYTES} bytes`
          : 'before the file ends';
      throw new SplatFileError('bad-header', file, `there is no end_header ${where}.`, {
        line: parser.lineCount + 1,
        byte: reader.byteOffset,
      });
    }
    scanned = 0;
    const text = new TextDecoder().decode(reader.bytes.subarray(reader.start, reader.start + length));
    if (parser.lineCount === 0 && reader.bytes[reader.start + length] === CR) {
      lineEnd = (await followedBy(reader, length, LF)) ? LF : CR;
    }
    const lineBytes = length + (lineEnd === LF && reader.bytes[reader.start + length] === CR ? 2 : 1);
    const done = parser.takeLine(text.trim(), reader.byteOffset);
    reader.advance(lineBytes);
    if (done) return { ...parser.finish(), lineEnd };
  }
}

async function findLineEnd(
  reader: ByteReader,
  endings: readonly number[],
  from: number,
): Promise<{ length: number; ended: boolean }> {
  let length = from;
  for (;;) {
    while (length < reader.available) {
      if (endings.includes(reader.bytes[reader.start + length])) return { length, ended: true };
      length++;
    }
    if (length >= MAX_HEADER_BYTES || !(await reader.fill(length + 1))) return { length, ended: false };
  }
}

async function followedBy(reader: ByteReader, length: number, byte: number): Promise<boolean> {
  return (await reader.fill(length + 2)) && reader.bytes[reader.start + length + 1] === byte;
}

interface MutableElement extends PlyElement {
  readonly properties: PlyProperty[];
}

class HeaderParser {
  lineCount = 0;
  readonly #file: string;
  readonly #elements: MutableElement[] = [];
  readonly #elementNames = new Set<string>();
  #format: PlyFormat | undefined;
  #byte = 0;
  #isAntialiased: boolean | undefined;
  #namesHarmonics = false;
  #writer: string | undefined;

  constructor(file: string) {
    this.#file = file;
  }

  /** Parses a line. Returns true at the end of the header. */
  takeLine(text: string, byte: number): boolean {
    this.lineCount++;
    this.#byte = byte;
    const words = text.split(/\s+/);
    if (this.lineCount === 1) {
      if (text !== 'ply')
        this.#fail('bad-header', `a PLY starts with a line "ply", this one with "${clip(text)}"`);
      return false;
    }
    switch (words[0]) {
      case 'end_header':
        return true;
      case 'format':
        this.#takeFormat(words);
        break;
      case 'element':
        this.#takeElement(words);
        break;
      case 'property':
        this.#takeProperty(words);
        break;
      case 'comment':
        this.#takeComment(words.slice(1).join(' '));
        break;
      case 'obj_info':
      case '':
        break;
      default:
        this.#fail('bad-header', `"${clip(text)}" is no line of a PLY header`);
    }
    return false;
  }

  finish(): Omit<PlyHeader, 'lineEnd'> {
    if (this.#format === undefined) this.#fail('bad-header', 'the header has no "format" line');
    return {
      format: this.#format,
      elements: this.#elements,
      isAntialiased: this.#isAntialiased,
      namesHarmonics: this.#namesHarmonics,
      writer: this.#writer,
      lineCount: this.lineCount,
    };
  }

  /** Brush writes a render mode, Postshot a flag. The last comment wins. */
  #takeComment(text: string): void {
    const mode = /^(?:SplatRenderMode: (default|mip|2dgs)|antialiased ([01]))$/i.exec(text);
    if (mode) this.#isAntialiased = mode[1]?.toLowerCase() === 'mip' || mode[2] === '1';
    if (/sh_degree|spherical harmonics/i.test(text)) this.#namesHarmonics = true;
    const writer = /^(?:generated|exported|created|written) (?:by|from|with) (.+)/i.exec(text);
    if (writer) this.#writer = clip(writer[1]);
  }

  #takeFormat([, format, version, ...more]: string[]): void {
    if (this.#format !== undefined) this.#fail('bad-header', 'a second "format" line');
    if (!FORMATS.includes(format) || version !== '1.0' || more.length > 0) {
      const found = [format, version, ...more].join(' ').trim();
      this.#fail('bad-header', `format "${clip(found)}" is not one of ${FORMATS.join(', ')}, version 1.0`);
    }
    this.#format = format as PlyFormat;
  }

  #takeElement([, name, countText, ...more]: string[]): void {
    if (countText === undefined || more.length > 0)
      this.#fail('bad-header', 'expected "element <name> <count>"');
    const count = Number(countText);
    if (!/^\d+$/.test(countText) || !Number.isSafeInteger(count)) {
      this.#fail('bad-header', `"${clip(countText)}" is no count of rows`, name);
    }
    if (this.#elementNames.has(name)) {
      this.#fail('bad-header', `element ${clip(name)} is declared twice`, name);
    }
    this.#elementNames.add(name);
    this.#elements.push({ name, count, properties: [] });
  }

  #takeProperty(words: string[]): void {
    const element = this.#elements.at(-1);
    if (element === undefined) this.#fail('bad-header', 'a "property" line before any "element" line');
    const isList = words[1] === 'list';
    if (words.length !== (isList ? 5 : 3)) {
      const expected = 'expected "property <type> <name>" or "property list <count type> <item type> <name>"';
      this.#fail('bad-header', expected, element.name);
    }
    const name = words[words.length - 1];
    const countType = isList ? this.#type(words[2], element.name, name) : undefined;
    if (countType === 'float32' || countType === 'float64') {
      this.#fail('bad-property', `a list's length cannot be ${words[2]}`, element.name, name);
    }
    element.properties.push({
      name,
      type: this.#type(words[words.length - 2], element.name, name),
      countType,
    });
  }

  #type(word: string, element: string, property: string): PlyType {
    const type = TYPES.get(word);
    if (type === undefined) {
      this.#fail(
        'bad-property',
        `"${clip(word)}" is no type; types are ${[...TYPES.keys()].join(', ')}`,
        element,
        property,
      );
    }
    return type;
  }

  #fail(code: SplatFileErrorCode, message: string, element?: string, property?: string): never {
    throw new SplatFileError(code, this.#file, `${message}.`, {
      line: this.lineCount,
      byte: this.#byte,
      element: element && clip(element),
      property: property && clip(property),
    });
  }
}

/** Text of a file, made short and printable for a message. */
export function clip(text: string): string {
  const printable = text.replace(/[^\x20-\x7e]/g, '·');
  return printable.length <= 60 ? printable : `${printable.slice(0, 60)}…`;
}

/** Properties of an element with spherical harmonics above degree 0. */
export interface ShProperties {
  /** Highest degree that is read. */
  readonly degree: ShDegree;
  /** Names up to `degree`, in the order of `ROW_SLOT`; files have red, then green, then blue. */
  readonly names: readonly string[];
  /** See `FileFacts`; undefined if all coefficients are read. */
  readonly note: string | undefined;
}

/**
 * Finds the harmonics of an element by its number of `f_rest` properties. Bands above degree 3,
 * which some trainers write, are ignored.
 *
 * @throws SplatFileError 'bad-property' if the number matches no degree.
 */
export function shPropertiesOf({ name, properties }: PlyElement, file: string): ShProperties {
  const count = properties.filter((property) => /^f_rest_\d+$/.test(property.name)).length;
  const fileDegree = Math.sqrt(count / 3 + 1) - 1;
  if (!Number.isInteger(fileDegree)) {
    throw new SplatFileError(
      'bad-property',
      file,
      `there are ${count} f_rest properties; spherical harmonics of degree 0, 1, 2, 3 or 4 have 0, 9, 24, 45 or 72. Export it again.`,
      { element: name },
    );
  }
  const degree = Math.min(3, fileDegree) as ShDegree;
  const perChannel = count / 3;
  const names = Array.from(
    { length: 3 * SH_REST_COEFFICIENTS[degree] },
    (_, i) => `f_rest_${(i % 3) * perChannel + Math.floor(i / 3)}`,
  );
  return { degree, names, note: leftOutBands(fileDegree) };
}
