import { describe, expect, it } from 'vitest';
import {
  baseName,
  formatBytes,
  formatBytesOf,
  formatCount,
  formatDb,
  formatMs,
  formatPsnr,
  formatRate,
  formatRough,
  formatSplats,
} from './format.ts';

describe('format', () => {
  it('writes errors, of identical images too', () => {
    expect(formatDb(48.26)).toBe('48.3');
    expect(formatDb(Number.POSITIVE_INFINITY)).toBe('identical');
    expect(formatPsnr(Number.POSITIVE_INFINITY)).toBe('identical to the reference');
  });

  it.each([
    [0.004, '0.00'],
    [0.42, '0.42'],
    [3.14, '3.1'],
    [99.96, '100'],
    [1234.5, '1,235'],
    [Number.NaN, '–'],
  ])('writes %f ms as %s', (value, text) => expect(formatMs(value)).toBe(text));

  it.each([
    [0, '0 B'],
    [999, '999 B'],
    [1000, '1.0 kB'],
    [999_600, '1.0 MB'],
    [34_400_000, '34 MB'],
    [1_200_000_000, '1.2 GB'],
    [Number.NaN, '–'],
  ])('writes %d bytes as %s', (value, text) => expect(formatBytes(value)).toBe(text));

  it.each([
    [3_000_000, 4_721_476, '3.0 of 4.7 MB'],
    [12_000, 4_721_476, '12 kB of 4.7 MB'],
  ])('writes %d of %d bytes as %s', (bytes, total, text) => expect(formatBytesOf(bytes, total)).toBe(text));

  it.each([
    [3.21, '3.2'],
    [59.94, '60'],
    [Number.NaN, '–'],
  ])('writes %f fps as %s', (value, text) => expect(formatRate(value)).toBe(text));

  it('groups thousands and counts one splat', () => {
    expect(formatCount(1234567)).toBe('1,234,567');
    expect(formatCount(Number.NaN)).toBe('–');
    expect(formatSplats(1)).toBe('1 splat');
    expect(formatSplats(20000)).toBe('20,000 splats');
  });

  it.each([
    ['https://example.com/a/garden%20small.ply?x=1#y', 'garden small.ply'],
    ['C:\\scenes\\a.ply', 'a.ply'],
    ['/bad%escape.ply', 'bad%escape.ply'],
    ['', ''],
  ])('takes the name off %s', (path, name) => expect(baseName(path)).toBe(name));
});

it.each([
  [0, '0'],
  [0.012345, '0.0123'],
  [8.4134, '8.41'],
  [1274.6, '1,270'],
  [-12.5, '−12.5'],
  [9_999_999, '10,000,000'],
  [1.234e9, '1.23 × 10⁹'],
  [-4.5e-12, '−4.50 × 10⁻¹²'],
  [Number.POSITIVE_INFINITY, '∞'],
  [Number.NaN, '–'],
])('%d is roughly %s', (value, text) => {
  expect(formatRough(value, 3)).toBe(text);
});
