import type { Choices } from './fuzz.ts';

/** Values that callers without types pass by mistake. */
const VALUES: readonly (() => unknown)[] = [
  ...[Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY, -0, 0, -1, 0.5, 3, 257].map(
    (n) => () => n,
  ),
  ...[1e39, 1e308, -1e308, 5e-324, 2 ** 53, 10n, true, false, null, undefined].map((value) => () => value),
  ...['', 'x', '3', 'NaN', 'toString', '__proto__', 'y'.repeat(5000)].map((text) => () => text),
  () => Symbol('s'),
  () => () => 3,
  () => ({}),
  () => Object.create(null),
  () => [],
  () => [1, 2],
  () => [Number.NaN, 0, 0],
  () => [1e39, 0, 0],
  () => ['a', 'b', 'c'],
  () => [undefined, null, Symbol('s')],
  () => Array(3),
  () => Array(100_000).fill(1),
  () => new Float32Array(16),
  () => new Float64Array(16).fill(Number.NaN),
  () => ({ length: 16 }),
  () => ({ length: 3, 0: 1, 1: 1, 2: 1 }),
  () => new Map(),
  () => new Date(Number.NaN),
];

/** Returns a copy of `value` with one part of it, at any depth, replaced, left out or added. */
export function withHostilePart(value: unknown, choices: Choices): unknown {
  const hostile = () => choices.of(VALUES)();
  const isOpen =
    typeof value === 'object' &&
    value !== null &&
    (Array.isArray(value) || ArrayBuffer.isView(value) || Object.getPrototypeOf(value) === Object.prototype);
  const names = isOpen ? Object.keys(value) : [];
  if (names.length === 0 || choices.isTrue(0.1)) return hostile();
  const name = choices.of(names);
  const copy: Record<string, unknown> = Object.assign(Array.isArray(value) ? [] : {}, value);
  if (ArrayBuffer.isView(value)) return Object.assign(Array.from(value as never), { [name]: hostile() });
  const change = choices.next();
  if (change < 0.05) delete copy[name];
  else if (change < 0.1) copy[choices.of(['toString', 'extra'])] = hostile();
  else copy[name] = withHostilePart((value as Record<string, unknown>)[name], choices);
  return copy;
}
