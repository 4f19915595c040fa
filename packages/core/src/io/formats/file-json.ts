import { SplatFileError } from '../../data/errors.ts';
import { shown } from '../../data/printable.ts';
import { messageOf } from '../sources/byte-reader.ts';

/** Most characters of a JSON path in messages; the end is kept. */
const MOST_PATH = 200;

/**
 * Typed access to the fields of a JSON object. Methods throw SplatFileError 'bad-header' for other
 * types.
 */
export class JsonFields {
  readonly #values: Readonly<Record<string, unknown>>;
  /** Path of this object within the file, with a dot at its end. */
  readonly #path: string;
  readonly #file: string;
  readonly #what: string;

  /** @param what `metadata of SOG` or another kind of JSON, for messages. */
  constructor(json: unknown, path: string, file: string, what: string) {
    this.#what = what;
    this.#path = path.length <= MOST_PATH ? path : `…${path.slice(-MOST_PATH)}`;
    this.#file = file;
    if (typeof json !== 'object' || json === null || Array.isArray(json))
      this.#fail(this.#path.replace(/\.$/, ''), json, 'an object');
    this.#values = json as Readonly<Record<string, unknown>>;
  }

  get(name: string): unknown {
    return Object.hasOwn(this.#values, name) ? this.#values[name] : undefined;
  }

  has(name: string): boolean {
    return (this.get(name) ?? null) !== null;
  }

  fields(name: string): JsonFields {
    return new JsonFields(this.get(name), `${this.#path}${name}.`, this.#file, this.#what);
  }

  number(name: string): number {
    const value = this.get(name);
    return Number.isFinite(value) ? (value as number) : this.fail(name, 'a number');
  }

  /** A non-negative integer. */
  count(name: string): number {
    const value = this.get(name);
    return Number.isSafeInteger(value) && (value as number) >= 0
      ? (value as number)
      : this.fail(name, 'a count');
  }

  numbers(name: string, length: number): number[] {
    const value = this.get(name);
    if (Array.isArray(value) && value.length === length && value.every(Number.isFinite)) return value;
    return this.fail(name, `a list of ${length} numbers`);
  }

  /** A list of file names. */
  names(name: string): string[] {
    const value = this.get(name);
    if (Array.isArray(value) && value.every((each) => typeof each === 'string')) return value;
    return this.fail(name, 'a list of file names');
  }

  /** A list of objects. */
  list(name: string): JsonFields[] {
    const value = this.get(name);
    if (!Array.isArray(value)) return this.fail(name, 'a list');
    return value.map(
      (each, i) => new JsonFields(each, `${this.#path}${name}[${i}].`, this.#file, this.#what),
    );
  }

  keys(): string[] {
    return Object.keys(this.#values);
  }

  fail(name: string, expected: string): never {
    return this.#fail(this.#path + name, this.get(name), expected);
  }

  #fail(property: string, value: unknown, expected: string): never {
    const found = value === undefined ? 'missing' : shown(typeof value === 'string' ? `"${value}"` : value);
    const place = property === '' ? 'it' : property;
    const message = `it is no ${this.#what}: ${place} is ${found}; it must be ${expected}.`;
    throw new SplatFileError('bad-header', this.#file, message, property === '' ? {} : { property });
  }
}

/** `,`, `[` and `{`: each value but the first follows one, so they bound the number of values. */
const COMMA = 0x2c;
const BRACKET = 0x5b;
const BRACE = 0x7b;

/**
 * Parses the JSON of a file.
 *
 * @param mostValues most values in it; each takes up to 64 bytes of memory.
 * @throws SplatFileError 'too-large', 'bad-header'
 */
export function parseJson(bytes: Uint8Array, file: string, mostValues: number): unknown {
  let valueCount = 1;
  for (const byte of bytes) if (byte === COMMA || byte === BRACKET || byte === BRACE) valueCount++;
  if (valueCount > mostValues) {
    const message = `its JSON may have ${valueCount} values; at most ${mostValues} are read. Export it in larger parts.`;
    throw new SplatFileError('too-large', file, message);
  }
  try {
    return JSON.parse(new TextDecoder().decode(bytes));
  } catch (cause) {
    const isTooLong = cause instanceof RangeError;
    const message = isTooLong
      ? `its JSON of ${bytes.length} bytes is too long for this browser. Export it in parts.`
      : `its JSON cannot be read (${shown(messageOf(cause))}). Download or export it again.`;
    throw new SplatFileError(isTooLong ? 'too-large' : 'bad-header', file, message, {}, { cause });
  }
}
