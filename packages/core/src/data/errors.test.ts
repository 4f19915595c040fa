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
