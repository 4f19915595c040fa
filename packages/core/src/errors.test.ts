import { describe, expect, test } from 'vitest';
import { SplatFileError, SplatSourceError } from './errors.ts';

describe('errors about sources', () => {
  test('keep the credentials of an address to themselves', () => {
    const address = 'https://me:p@ss:word@example.org:8080/a@b.ply?key=1@2';
    const shown = 'https://example.org:8080/a@b.ply?key=1@2';
    const source = new SplatSourceError(address, `cannot be fetched: ${address} is bad`);
    expect(source.message).toBe(`${shown}: cannot be fetched: ${shown} is bad`);
    expect(source.file).toBe(shown);
    const file = new SplatFileError('empty', address, 'no splats.', { row: 2 });
    expect(file.message).toBe(`${shown}: no splats. (row 2)`);
    expect(file.file).toBe(shown);
  });

  test('show no character that a terminal obeys or that turns text around', () => {
    const name = 'a\u001b[31m\r\n\u202eylp.\u2028\u009b\t\u2066é 日.ply';
    const shown = 'a·[31m···ylp.····é 日.ply';
    expect(new SplatSourceError(name, `answered 500 \u0007`, 500).message).toBe(`${shown}: answered 500 ·`);
    expect(new SplatFileError('empty', name, 'no splats.').file).toBe(shown);
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
