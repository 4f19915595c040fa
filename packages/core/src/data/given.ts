import { InvalidArgumentError } from './errors.ts';
import { isArrayOrTyped, isDetached, shown } from './printable.ts';

/** Tests of values, by the words that messages have for them. */
const KINDS = {
  'an object': (value: unknown) => typeof value === 'object' && value !== null,
  'a function': (value: unknown) => typeof value === 'function',
  'a number': (value: unknown) => typeof value === 'number',
  'a whole number': (value: unknown) => Number.isSafeInteger(value) && (value as number) >= 0,
  'a string': (value: unknown) => typeof value === 'string',
  'a list': Array.isArray,
  'a typed array': (value: unknown) => ArrayBuffer.isView(value) && isArrayOrTyped(value),
  'an ArrayBuffer': (value: unknown) => tagOf(value) === 'ArrayBuffer' && !isDetached(value),
  'an AbortSignal': (value: unknown) => tagOf(value) === 'AbortSignal',
} as const;

type Kind = keyof typeof KINDS;
/** Members of an object and their kinds; `?` stands for one that may be left out. */
export type Members = Readonly<Record<string, Kind | `${Kind}?`>>;

/** Options of everything that takes time. */
const WATCHED: Members = { signal: 'an AbortSignal?', onProgress: 'a function?' };

/** An engine, for functions that take one. */
export const ENGINE: Members = { createView: 'a function' };
/** A cloud, packed or on the GPU, for functions that take either. */
export const SPLATS: Members = {
  count: 'a number',
  origin: 'a list',
  robustBounds: 'an object',
  chunks: 'an ArrayBuffer',
};
/** A cloud on the GPU, for functions that take one. */
export const CLOUD: Members = { checkUsable: 'a function' };

/**
 * Returns `value` if it is an object that has these members, for arguments of callers without types.
 *
 * @param argument name of the argument; members of `options` are named alone.
 * @throws InvalidArgumentError naming the argument or the member.
 */
export function given<T extends object>(value: T, members: Members = {}, argument = 'options'): T {
  checkKind(argument, value, 'an object');
  const prefix = argument === 'options' ? '' : `${argument}.`;
  if (!prefix) checkMembers(value, WATCHED, prefix);
  checkMembers(value, members, prefix);
  return value;
}

function checkMembers<T extends object>(value: T, members: Members, prefix: string): void {
  // Quicker than `Object.entries`: frames check each of their clouds.
  for (const name in members) checkKind(prefix + name, value[name as keyof T], members[name]);
}

/** @throws InvalidArgumentError unless `value` is of this kind. */
export function checkKind(argument: string, value: unknown, kind: Kind | `${Kind}?`): void {
  const expected = kind.replace('?', '') as Kind;
  if (value === undefined && kind !== expected) return;
  if (!KINDS[expected](value)) throw wrongArgument(argument, value, expected);
}

/** Returns the error for a value that is not `expected`. @param owner thing that it is of. */
export function wrongArgument(
  argument: string,
  value: unknown,
  expected: string,
  owner?: string,
): InvalidArgumentError {
  const message = `${argument} is ${shown(value)}; it must be ${expected}.`;
  return new InvalidArgumentError(argument, owner ? `${owner}: ${message}` : message);
}

/** The class of an object, also of one that another frame of the page has made. */
function tagOf(value: unknown): string {
  return Object.prototype.toString.call(value).slice('[object '.length, -1);
}
