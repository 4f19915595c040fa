import { describe, expect, test } from 'vitest';
import { SplatFileError, SplatSourceError } from './errors.ts';
import { printable, shown } from './printable.ts';

describe('errors about sources', () => {
  test('keep the credentials of an address to themselves', () => {
    const address = 'https://me:p@ss:word@example.org:8080/a@b.ply?key=1@2';
    const expected = 'https://example.org:8080/a@b.ply?key=1@2';
    const source = new SplatSourceError(address, `cannot be fetched: ${address} is bad`);
    expect(source.message).toBe(`${expected}: cannot be fetched: ${expected} is bad`);
    expect(source.file).toBe(expected);
    const file = new SplatFileError('empty', address, 'no splats.', { row: 2 });
    expect(file.message).toBe(`${expected}: no splats. (row 2)`);
    expect(file.file).toBe(expected);
  });

  test.each([
    ['//me:secret@example.org/a.ply', '//example.org/a.ply'],
    ['https:me:secret@example.org/a.ply', 'https:example.org/a.ply'],
    ['https:/me:secret@example.org/a.ply', 'https:/example.org/a.ply'],
    ['HTTPS:\\\\me:secret@example.org\\a@b.ply', 'HTTPS:\\\\example.org\\a@b.ply'],
    ['https://me:my secret@example.org/a.ply', 'https://example.org/a.ply'],
    ['see (//me:secret@example.org)', 'see (//example.org)'],
  ])('nor where it is written as browsers also take it: %s', (address, expected) => {
    expect(new SplatSourceError(address, 'x').file).toBe(expected);
  });

  test('nor where it is cut, or without end', () => {
    expect(shown(`https://me:${'secret'.repeat(20)}@example.org/`)).toBe('https://example.org/');
    const long = 'http:'.repeat(1 << 20);
    expect(printable(long)).toBe(long);
  });

  test('show no character that a terminal obeys or that turns text around', () => {
    const name = 'a\u001b[31m\r\n\u202eylp.\u2028\u009b\t\u2066é 日.ply';
    const expected = 'a·[31m···ylp.····é 日.ply';
    expect(new SplatSourceError(name, `answered 500 \u0007`, 500).message).toBe(
      `${expected}: answered 500 ·`,
    );
    expect(new SplatFileError('empty', name, 'no splats.').file).toBe(expected);
  });

  test('leave other names as they are', () => {
    for (const name of [
      'me@home.ply',
      'folder//me@home.ply',
      'C:\\scenes\\a.ply',
      'data:,a@b',
      'https://example.org/@me',
    ])
      expect(new SplatSourceError(name, 'x').file).toBe(name);
  });
});

/**
 * @fault Arguments: a value in a message contains itself, or has any depth, length or number of keys
 * @consequence the message shows its beginning, up to 80 characters
 */
describe('values in messages', () => {
  const self: unknown[] = [];
  for (let i = 0; i < 80; i++) self.push(self);
  const loop: Record<string, unknown> = {};
  loop.loop = loop;
  const deep = (depth: number) => JSON.parse(`${'['.repeat(depth)}${']'.repeat(depth)}`);
  const throwing = Object.defineProperty({}, 'a', {
    enumerable: true,
    get: () => {
      throw new Error('no');
    },
  });

  test.each<[string, unknown, RegExp]>([
    ['an array in itself', self, /^\[{80}…$/],
    ['an object in itself', loop, /^\{loop: \{loop: /],
    ['a list 100,000 deep', deep(100_000), /^\[{80}…$/],
    ['objects 100,000 deep', JSON.parse(`${'{"a":'.repeat(1e5)}1${'}'.repeat(1e5)}`), /^(\{a: ){20}…$/],
    ['a million numbers', new Array(1e6).fill(1), /^\[1, 1, .*…$/],
    ['a million numbers of a typed array', new Float32Array(1e6), /^\[0, 0, .*…$/],
    [
      '130,000 keys',
      Object.fromEntries(Array.from({ length: 130_000 }, (_, i) => [i, 0])),
      /^\{0: 0, 1: 0, /,
    ],
    ['a getter that throws', throwing, /^an unusual object$/],
    ['a method that is none', { toString: 1 }, /^\{toString: 1\}$/],
    ['an object of no class', Object.create(null), /^\{\}$/],
    ['a symbol', Symbol('s'), /^Symbol\(s\)$/],
    ['a big integer', 10n, /^10$/],
    ['a date that is none', new Date(Number.NaN), /^Invalid Date$/],
    ['nothing', [undefined, null, Number.NaN], /^\[undefined, null, NaN\]$/],
    ['lists in objects', { a: [1, { b: 'c' }] }, /^\{a: \[1, \{b: "c"\}\]\}$/],
    ['long text', 'y'.repeat(1e7), /^y{80}…$/],
    ['long text in an object', { ['k'.repeat(1e6)]: 'y'.repeat(1e6) }, /^\{k{79}…$/],
    ['credentials before more than is read', `https://me:${'secret'.repeat(1e6)}@a.org/`, /^https:\/\/$/],
  ])('are short, also of %s', (_, value, expected) => {
    const text = shown(value);
    expect(text).toMatch(expected);
    expect(text.length).toBeLessThanOrEqual(81);
  });

  test('read no further than they are printed', () => {
    let reads = 0;
    const unread = new Proxy(new Array<number>(100_000).fill(0), {
      get: (list, key) => {
        if (typeof key === 'string' && /^\d+$/.test(key)) reads++;
        return Reflect.get(list, key);
      },
    });
    for (let length = 900; length < 1100; length++) shown({ a: 'x'.repeat(length), b: unread });
    expect(reads).toBeLessThan(200_000);
  });
});
