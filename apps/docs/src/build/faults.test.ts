import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { assembled } from './build-site.ts';
import { faultsIn, proofsIn, withFaults, withProofs } from './faults.ts';
import { DocsError } from './markdown.ts';

const commented = (...lines: readonly string[]) =>
  `const a = 1;\n\n  /**\n${lines.map((line) => `   * ${line}\n`).join('')}   */\n  test('a', () => {});\n`;

describe('annotations of tests', () => {
  it('become failure modes by section, whose texts may go on in further lines', () => {
    const one = commented(
      '@fault Servers: a: b',
      '  and c',
      '@consequence `E`; d',
      '@fault GPU memory: e',
      '@consequence f',
    );
    const two = "/** @fault Servers: a: b and c */\ntest('b', () => {});\n/** Unrelated. */";
    const faults = faultsIn(new Map(Object.entries({ 'x.test.ts': one, 'y.test.ts': two })));
    expect(faults).toEqual([
      { section: 'GPU memory', fault: 'e', consequence: 'f', tests: ['x.test.ts'] },
      { section: 'Servers', fault: 'a: b and c', consequence: '`E`; d', tests: ['x.test.ts', 'y.test.ts'] },
    ]);
    expect(withFaults('# A\n\n<!-- faults -->\n\nB', faults)).toBe(
      [
        '# A',
        '',
        '## GPU memory',
        '',
        '| fault | consequence | tests |',
        '|---|---|---|',
        '| e | f | `x.test.ts` |',
        '',
        '## Servers',
        '',
        '| fault | consequence | tests |',
        '|---|---|---|',
        '| a: b and c | `E`; d | `x.test.ts`, `y.test.ts` |',
        '',
        'B',
      ].join('\n'),
    );
  });

  it.each([
    [
      'an unknown section',
      ['@fault Weather: rain', '@consequence wet'],
      /x\.test\.ts: “@fault Weather” begins/,
    ],
    ['no consequence', ['@fault Time: late'], /“Time: late” has 0 consequences/],
    [
      'several consequences',
      ['@fault Time: late', '@consequence a', '@fault Time: late', '@consequence b'],
      /“Time: late” has 2 consequences/,
    ],
  ])('with %s are errors that name the file', (_, lines, message) => {
    const collect = () => faultsIn(new Map([['x.test.ts', commented(...lines)]]));
    expect(collect).toThrow(DocsError);
    expect(collect).toThrow(message);
  });
});

it('a first line “Proves” becomes a row, with the lines that it goes on in', () => {
  const proofs = proofsIn(
    new Map([
      ['a.test.ts', "// Proves: one thing\n// and another.\nimport 'x';\n// More."],
      ['b.test.ts', '// Anything else.'],
    ]),
  );
  expect(withProofs('<!-- proofs -->', proofs)).toBe(
    '| file | proves |\n|---|---|\n| `a.test.ts` | one thing and another. |',
  );
});

it('the site lists the failure modes and the proofs of the repository’s tests', () => {
  const { pages } = assembled();
  const rowsOf = (page: string) => pages.get(page)?.match(/^\| .*\.test\.(?:ts|tsx|mjs)` /gm) ?? [];
  expect(rowsOf('contribute/faults.md').length).toBeGreaterThan(200);
  expect(rowsOf('contribute/tests.md').length).toBeGreaterThan(80);
  const root = new URL('../../../../', import.meta.url);
  expect(readFileSync(new URL('docs/faults.md', root), 'utf8')).toContain('\n<!-- faults -->\n');
});
