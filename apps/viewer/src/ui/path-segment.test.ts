import fc from 'fast-check';
import { expect, test } from 'vitest';
import { pathSegment } from './path-segment.ts';

test.each([
  'garden.ply',
  'My garden, v1.5.spz',
  'größe 庭.sog',
  'a & b.ply',
  '50% a.ply',
  'console.ply',
  'a..b',
])('%s stays as it is', (name) => expect(pathSegment(name)).toBe(name));

test.each([
  ['../x.ply', '__x.ply'],
  ['..\\..\\x.ply', '__.._x.ply'],
  ['..', '_'],
  ['.', '_'],
  ['', '_'],
  ['.htaccess', '_htaccess'],
  ['/etc/passwd', '_etc_passwd'],
  ['C:\\x.ply', 'C__x.ply'],
  ['a\0b\nc\rd\u2028e.ply', 'a_b_c_d_e.ply'],
  ['a\u202eylp.exe', 'a_ylp.exe'],
  ['\ufeffa\u200b.ply', '_a_.ply'],
  ['NUL', '_NUL'],
  ['con.ply', '_con.ply'],
  ['Aux .ply', '_Aux .ply'],
  ['Lpt1.compressed.ply', '_Lpt1.compressed.ply'],
  ['COM\u00b9.ply', '_COM\u00b9.ply'],
  ['a. . ', 'a_'],
  ['a\ud800b', 'a_b'],
])('%j becomes %j', (name, segment) => expect(pathSegment(name)).toBe(segment));

test('long names keep their ends', () => {
  const segment = pathSegment(`${'庭'.repeat(300)}.compressed.ply`);
  expect(new TextEncoder().encode(segment).length).toBeLessThanOrEqual(200);
  expect(segment).toMatch(/^庭+\.compressed\.ply$/);
});

test.each(['. ', '.', ' '])('a long run of %j takes no longer than other text', (run) => {
  const segment = pathSegment(`a${run.repeat(10_000)}b.ply`);
  expect(segment).toMatch(/^a.+\.ply$/);
  expect(pathSegment(`a${run.repeat(10_000)}`)).toBe('a_');
});

/**
 * @fault Saved files: the name of a scene or a file leads out of its folder, is a device of Windows, has
 *   control or bidirectional characters, or is of any length
 * @consequence it becomes one segment of a path
 */
test('any text becomes one part of a path, once', () => {
  fc.assert(
    fc.property(fc.string({ unit: 'binary', maxLength: 300 }), (name) => {
      const segment = pathSegment(name);
      expect(segment).toMatch(/^[^./\\\0][^/\\\0]*$/u);
      expect(segment).not.toMatch(/[. ]$/);
      expect(new TextEncoder().encode(segment).length).toBeLessThanOrEqual(200);
      expect(() => encodeURIComponent(segment)).not.toThrow();
      expect(pathSegment(segment)).toBe(segment);
    }),
  );
});
