import { InvalidArgumentError } from '@websplatter/core';
import { isFiniteF32 } from './float32.ts';
import type { Vec3 } from './vec3.ts';

/**
 * A parameter of the viewer's URL. Its numbers are the shortest that read back as the same float64,
 * so that the picture stays the same bit for bit.
 */
export interface LinkField<Value, Read = Value, Text extends string | null = string> {
  /** Its name in the query. */
  readonly name: string;
  encode(value: Value): Text;
  /** @throws InvalidArgumentError naming the invalid part, and the syntax. */
  decode(text: string): Read;
}

/** Makes the error for an invalid part. */
export type Refuse = (why: string) => InvalidArgumentError;

/**
 * A field whose errors begin with `subject`, such as "The camera", and end with `form`, the syntax;
 * null if `decode` says it.
 */
export function linkField<Value, Read, Text extends string | null>(
  name: string,
  { subject, form }: { readonly subject: string; readonly form: string | null },
  encode: (value: Value) => Text,
  decode: (text: string, refuse: Refuse) => Read,
): LinkField<Value, Read, Text> {
  const refuse = (why: string) => {
    const syntax = form === null ? '' : `; write ${form}`;
    return new InvalidArgumentError(name, `${subject} cannot be read: ${why}${syntax}.`);
  };
  return { name, encode, decode: (text) => decode(text, refuse) };
}

/** A part `name:value` of a field. */
export interface LinkPart<Value> {
  /** The part is left out if this is its value; without `usual` it is written whenever there is a value. */
  readonly usual?: Value;
  write(value: Value): string;
  /** @throws the error of `refuse` for an invalid text. */
  read(text: string, refuse: Refuse, name: string): Value;
}

type LinkParts = Readonly<Record<string, LinkPart<unknown>>>;

/** Values of parts by their names. */
export type LinkValues<Parts> = {
  readonly [Name in keyof Parts]: Parts[Name] extends LinkPart<infer Value> ? Value : never;
};

/** The parts that are not as usual, in the order of the table. */
export function writeParts<Parts extends LinkParts>(
  parts: Parts,
  values: { readonly [Name in keyof Parts]: LinkValues<Parts>[Name] | undefined },
): string[] {
  return Object.entries(parts).flatMap(([name, part]) => {
    const value = values[name];
    if (value === undefined) return [];
    const text = part.write(value);
    return 'usual' in part && text === part.write(part.usual) ? [] : [`${name}:${text}`];
  });
}

/**
 * The values that the texts name; the last one of a name counts.
 *
 * @throws the error of `refuse` for a name that is not in the table, or an invalid value.
 */
export function readParts<Parts extends LinkParts>(
  parts: Parts,
  texts: readonly string[],
  refuse: Refuse,
): Partial<LinkValues<Parts>> {
  const named = new Map(
    texts.map((text) => {
      const at = text.indexOf(':');
      const name = text.slice(0, Math.max(0, at));
      if (!Object.hasOwn(parts, name)) throw refuse(`“${text}” is not one of its parts`);
      return [name, text.slice(at + 1)];
    }),
  );
  const values = Object.entries(parts).flatMap(([name, part]) => {
    const text = named.get(name);
    return text === undefined ? [] : [[name, part.read(text, refuse, name)]];
  });
  return Object.fromEntries(values) as Partial<LinkValues<Parts>>;
}

/** A part that is there or not: `name:1`. */
export const FLAG: LinkPart<boolean> = {
  usual: false,
  write: (isSet) => (isSet ? '1' : '0'),
  read: (text) => text === '1',
};

/** A part `name:12.5`, whose errors say why its number is refused; null if it is not. */
export function numberPart(
  usual: number,
  whyNot: (value: number) => string | null,
  read = readNumber,
): LinkPart<number> {
  return {
    usual,
    write: String,
    read: (text, refuse, name) => {
      const value = read(text, refuse);
      const why = whyNot(value);
      if (why !== null) throw refuse(`${name}:${text} ${why}`);
      return value;
    },
  };
}

/** Reads a number that is finite as float32, too. @throws the error of `refuse` for another text. */
export function readNumber(text: string, refuse: Refuse): number {
  const value = readFloat64(text, refuse);
  if (!isFiniteF32(value)) throw refuse(`${text} is no number of float32`);
  return value;
}

/** Reads a finite number. @throws the error of `refuse` for another text. */
export function readFloat64(text: string, refuse: Refuse): number {
  const value = text === '' ? Number.NaN : Number(text);
  if (!Number.isFinite(value)) throw refuse(text === '' ? 'a number is missing' : `“${text}” is no number`);
  return value;
}

/**
 * Reads three numbers, `x:y:z`.
 *
 * @param source how errors name the text.
 * @throws the error of `refuse` for another text.
 */
export function readVector(text: string, refuse: Refuse, source = text, read = readNumber): Vec3 {
  const [x, y, z, ...others] = text.split(':').map((part) => read(part, refuse));
  if (z === undefined || others.length > 0) throw refuse(`${source} is not three numbers`);
  return [x, y, z];
}
