import { expect, test } from 'vitest';
import { mutantsOf } from './mutants.mjs';

/** The text after each mutant. */
const allOf = (path, text) =>
  mutantsOf(path, text).map(({ start, end, text: other }) => text.slice(0, start) + other + text.slice(end));

test('operators, numbers, conditions and pairs of scripts', () => {
  expect(allOf('a.ts', 'const a = b + 2;')).toEqual(['const a = b - 2;', 'const a = b + (2 + 1);']);
  expect(allOf('a.ts', 'if (!a && b <= c) d();')).toEqual([
    'if (a && b <= c) d();',
    'if (!a || b <= c) d();',
    'if (!a && b < c) d();',
  ]);
  expect(allOf('a.ts', 'f(a ? b : c);')).toEqual(['f(a ? c : b);']);
  expect(allOf('a.ts', 'f(a.b, c); g(a, f());')).toEqual(['f(c, a.b); g(a, f());']);
  expect(allOf('a.ts', 'x += -y;')).toEqual(['x -= -y;', 'x += y;']);
});

test('neither texts nor types of scripts', () => {
  expect(allOf('a.ts', "const a: 1 | 2 = f('1 + 2', 'b' + d);")).toEqual([]);
});

test('operators, numbers and components of shaders, but not their imports, types and comments', () => {
  const text = 'import a::b1;\n@group(0) @binding(19) var<storage> c: array<vec4f, 3>; // 1 + 2\n';
  expect(allOf('a.wgsl', text)).toEqual([]);
  expect(allOf('a.wgsl', 'let a = b.x * 2.5 - c[3u];')).toEqual([
    'let a = b.y * 2.5 - c[3u];',
    'let a = b.x / 2.5 - c[3u];',
    'let a = b.x * (2.5 * 2.0) - c[3u];',
    'let a = b.x * 2.5 + c[3u];',
    'let a = b.x * 2.5 - c[4u];',
  ]);
  expect(allOf('a.wgsl', 'let a = min(b.xy, d);')).toEqual([
    'let a = max(b.xy, d);',
    'let a = min(b.yx, d);',
  ]);
});
