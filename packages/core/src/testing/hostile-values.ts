const LONG_LIST = Array(100_000).fill(1);

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
  () => LONG_LIST,
  () => new Float32Array(16),
  () => new Float64Array(16).fill(Number.NaN),
  () => ({ length: 16 }),
  () => ({ length: 3, 0: 1, 1: 1, 2: 1 }),
  () => new Map(),
  () => new Date(Number.NaN),
];

/** Names of members that the values of callers may have, but no argument of the interface. */
const ADDED = ['toString', 'extra'];

/**
 * Yields `value` with one part of it, at any depth, replaced by each hostile value or left out; and
 * hostile members added. Every part is met by every value.
 */
export function* hostileVersions(value: unknown): Generator<unknown> {
  for (const make of VALUES) yield make();
  const isOpen =
    typeof value === 'object' &&
    value !== null &&
    (Array.isArray(value) || ArrayBuffer.isView(value) || Object.getPrototypeOf(value) === Object.prototype);
  if (!isOpen) return;
  const copyOf = () =>
    Array.isArray(value) || ArrayBuffer.isView(value) ? Array.from(value as never) : { ...value };
  const withPart = (name: string, part: unknown) => Object.assign(copyOf(), { [name]: part });
  for (const [name, part] of Object.entries(value)) {
    for (const version of hostileVersions(part)) yield withPart(name, version);
    const lacking: Record<string, unknown> = withPart(name, undefined);
    delete lacking[name];
    yield lacking;
  }
  for (const name of ADDED) for (const make of VALUES) yield withPart(name, make());
}
