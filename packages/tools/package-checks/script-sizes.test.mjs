import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { afterAll, expect, test } from 'vitest';
import { scriptCircles, scriptSizes } from './script-sizes.mjs';

const MANIFEST = {
  'index.html': { file: 'index.js', imports: ['_shared.js'], dynamicImports: ['panel.ts', 'cases.ts'] },
  '_shared.js': { file: 'shared.js' },
  'panel.ts': { file: 'panel.js', name: 'panel', imports: ['index.html', '_shared.js', '_panel-part.js'] },
  '_panel-part.js': { file: 'panel-part.js' },
  'cases.ts': { file: 'cases.js', imports: ['_case-data.js'] },
  '_case-data.js': { file: 'case-data.js' },
};

const folder = mkdtempSync(join(tmpdir(), 'websplatter-script-sizes-'));
afterAll(() => rmSync(folder, { recursive: true, force: true }));

mkdirSync(join(folder, '.vite'));
writeFileSync(join(folder, '.vite/manifest.json'), JSON.stringify(MANIFEST));
for (const { file } of Object.values(MANIFEST)) writeFileSync(join(folder, file), scriptOf(file));

function scriptOf(file) {
  return `// ${file.repeat(file.length)}`;
}

function sizeOf(...files) {
  return files.reduce((sum, file) => sum + gzipSync(scriptOf(file)).length, 0);
}

test('scripts count once, and those that are fetched later not at first', () => {
  expect(scriptSizes(folder, [], [])).toEqual({
    initial: sizeOf('index.js', 'shared.js'),
    all: sizeOf('index.js', 'shared.js', 'panel.js', 'panel-part.js', 'cases.js', 'case-data.js'),
  });
});

test('scripts that are always fetched count at first', () => {
  const { initial } = scriptSizes(folder, ['panel'], []);
  expect(initial).toBe(sizeOf('index.js', 'shared.js', 'panel.js', 'panel-part.js'));
});

test('neither modules apart count, nor scripts that only those need', () => {
  const { all } = scriptSizes(folder, [], ['cases.ts']);
  expect(all).toBe(sizeOf('index.js', 'shared.js', 'panel.js', 'panel-part.js'));
});

test('a module that is no script of its own cannot be apart or fetched first', () => {
  expect(() => scriptSizes(folder, [], ['cases.tsx'])).toThrow('no script of its own for cases.tsx');
  expect(() => scriptSizes(folder, ['panel', 'pane'], [])).toThrow('no script of its own for pane');
});

test('scripts that import themselves by way of others are named', () => {
  expect(scriptCircles(folder)).toEqual([]);
  const circle = { ...MANIFEST, '_shared.js': { file: 'shared.js', imports: ['_panel-part.js'] } };
  circle['_panel-part.js'] = { file: 'panel-part.js', imports: ['_shared.js'] };
  const other = mkdtempSync(join(tmpdir(), 'websplatter-script-circles-'));
  mkdirSync(join(other, '.vite'));
  writeFileSync(join(other, '.vite/manifest.json'), JSON.stringify(circle));
  expect(scriptCircles(other)).toEqual(['shared.js', 'panel-part.js']);
  rmSync(other, { recursive: true });
});
