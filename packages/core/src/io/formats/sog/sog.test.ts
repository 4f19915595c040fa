import { describe, expect, test } from 'vitest';
import { isPalette, readCoefficients } from '../../../data/packing/harmonics.ts';
import type { RowLayout } from '../../../data/packing/row-layout.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { Choices } from '../../../testing/fuzz.ts';
import { type FileRows, rowsOf } from '../../../testing/rows-of.ts';
import {
  droppedFiles,
  type SogExample,
  type SogFixture,
  sogExample,
  sogFiles,
} from '../../../testing/sog-fixture.ts';
import { rgbaWebp, vp8lBytes, webpBytes } from '../../../testing/webp-fixture.ts';
import { zipBytes } from '../../../testing/zip-fixture.ts';
import { readSource } from '../../loading/read-source.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { knownSource } from '../../sources/known-source.ts';
import type { LoadProgress, ReadSplatsOptions, SplatSource } from '../../sources/splat-source.ts';
import { ALL_READERS } from '../readers.ts';
import { FLAT_LOG_SCALE } from '../rows/flat-scale.ts';

const exampleOf = (fixture: Partial<SogFixture> = {}, seed = 1) =>
  sogExample({ version: 2, count: 11, shDegree: 1, ...fixture }, new Choices(seed));

/** Compares rows with float64: every step is in float64 but the last, which rounds to float32. */
function expectRows({ layout, values }: FileRows, rows: SogExample['rows']): void {
  expect(layout.count).toBe(rows.length);
  const expected = rows.flat();
  expect(values.length).toBe(expected.length);
  expected.forEach((value, i) => {
    // The test's own steps are in another order.
    if (Math.abs(values[i] - value) > 2 ** -23 * Math.max(1e-3, Math.abs(value)))
      throw new Error(`value ${i % (values.length / rows.length)} of a row is ${values[i]}, not ${value}`);
  });
}

/** Reads and keeps a palette, compares the set with rows, and returns the number of entries. */
async function entriesKept(source: SplatSource): Promise<number | null> {
  const kept = await readSource(knownSource(source), { shPrecision: 'palette' }, ALL_READERS);
  const own = await readSource(knownSource(source), { shPrecision: 'f32' }, ALL_READERS);
  expect(isPalette(own.harmonics)).toBe(false);
  const coefficients = [kept, own].map(({ harmonics, count }) => {
    const length = coefficientsPerSplat(harmonics.degree);
    const all = new Float32Array(count * length);
    for (let i = 0; i < count; i++)
      readCoefficients(harmonics, i, all.subarray(i * length, (i + 1) * length));
    return all;
  });
  expect(coefficients[0]).toEqual(coefficients[1]);
  expect({ ...kept, harmonics: null }).toEqual({ ...own, harmonics: null });
  return isPalette(kept.harmonics)
    ? kept.harmonics.entries.length / coefficientsPerSplat(kept.harmonics.degree)
    : null;
}

/** Stands for lists in lists, which are too deep for JSON.stringify. */
const deep = (depth: number) => `deep ${depth}`;

/** Files in whose JSON lists are as deep as `deep` says. */
const deepened = (files: Record<string, Uint8Array<ArrayBuffer>>) =>
  Object.fromEntries(
    Object.entries(files).map(([path, bytes]) => {
      if (!path.endsWith('.json')) return [path, bytes];
      const text = new TextDecoder().decode(bytes);
      const nested = (_: string, depth: string) => '['.repeat(Number(depth)) + ']'.repeat(Number(depth));
      return [path, new TextEncoder().encode(text.replace(/"deep (\d+)"/g, nested))];
    }),
  );

const failure = (example: SogExample, options: ReadSplatsOptions = {}) =>
  fileErrorOf(rowsOf(droppedFiles(deepened(sogFiles(example))), options));

describe('reads', () => {
  for (const version of [1, 2] as const) {
    test.each([0, 1, 2, 3] as const)(`version ${version}, SH degree %i`, async (shDegree) => {
      const example = exampleOf({ version, shDegree, count: 37, paletteSize: 130 });
      const rows = await rowsOf(droppedFiles(sogFiles(example)));
      expect(rows.layout.shDegree).toBe(shDegree);
      expectRows(rows, example.rows);
    });
  }

  test('a set, where there is no sink for rows', async () => {
    const { meta, images, rows } = exampleOf({ count: 5 });
    const files = droppedFiles(sogFiles({ meta, images, rows }));
    const set = await readSource(knownSource(files), { shPrecision: 'f32' }, ALL_READERS);
    expect(set).toMatchObject({ count: 5, dropped: {}, harmonics: { degree: 1 } });
    expect(set.fileFacts).toEqual({ format: 'sog', variant: '2' });
    expect([...set.opacityLogits]).toEqual(rows.map((row) => Math.fround(row[ROW_SLOT.opacity])));
  });

  test('a palette of a thousand colours', async () => {
    const example = exampleOf({ count: 300, shDegree: 1, paletteSize: 1000 });
    expectRows(await rowsOf(droppedFiles(sogFiles(example))), example.rows);
  });

  test.each([1, 2, 3] as const)('its palette of degree %i, where that is asked for', async (shDegree) => {
    const example = exampleOf({ shDegree, count: 37, paletteSize: 130 });
    expect(await entriesKept(droppedFiles(sogFiles(example)))).toBe(130);
    const sink = {
      mayDetach: false,
      begin: () => expect.fail(),
      memory: () => expect.fail(),
      take: () => {},
    };
    const rowsTo = { sink, files: { minRows: 0, maxRows: 1000, pieceBytes: 1000 } };
    const zipped = zipBytes(sogFiles(example));
    expect(
      await readSource(knownSource(zipped), { shPrecision: 'palette' }, ALL_READERS, rowsTo),
    ).not.toBeNull();
    expect(await entriesKept(droppedFiles(sogFiles(exampleOf({ shDegree: 0 }))))).toBeNull();
  });

  test('opacities of 0 and 1', async () => {
    const example = exampleOf({ count: 2, width: 2 });
    example.images['sh0.webp'] = rgbaWebp(2, 1, Uint8Array.of(1, 2, 3, 0, 1, 2, 3, 255));
    const set = await readSource(knownSource(droppedFiles(sogFiles(example))), {}, ALL_READERS);
    expect([...set.opacityLogits]).toEqual([Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY]);
  });

  test('other names, and unknown fields', async () => {
    const example = exampleOf();
    example.meta.quats = { files: ['images/turned.webp'], later: [1] };
    example.images['images/turned.webp'] = example.images['quats.webp'];
    expectRows(await rowsOf(droppedFiles(sogFiles(example))), example.rows);
  });

  test('a codebook without its first value', async () => {
    const example = exampleOf({ count: 1, width: 1 });
    example.meta.scales.codebook[0] = null;
    example.images['scales.webp'] = rgbaWebp(1, 1, Uint8Array.of(0, 1, 255, 255));
    const { values } = await rowsOf(droppedFiles(sogFiles(example)));
    const [first, second, last] = values.slice(ROW_SLOT.logScale, ROW_SLOT.logScale + 3);
    expect(first).toBeCloseTo(second + (second - last) / 255, 5);
  });

  test.each([
    [{ model: 'antialiased' }, true],
    [{ model: 'default' }, false],
    [{ model: '2dgs' }, false],
    [{ antialias: true }, true],
    [{ antialias: false }, false],
    [{}, undefined],
  ])('%j', async (flags, isAntialiased) => {
    const example = exampleOf();
    Object.assign(example.meta, flags);
    expect((await rowsOf(droppedFiles(sogFiles(example)))).layout.isAntialiased).toBe(isAntialiased);
  });

  test('splats of 2DGS are as flat as in a PLY', async () => {
    const example = exampleOf({ shDegree: 0 });
    example.meta.model = '2dgs';
    const flat = (row: readonly number[]) =>
      row.map((value, slot) => (slot === ROW_SLOT.logScale + 2 ? FLAT_LOG_SCALE : value));
    expectRows(await rowsOf(droppedFiles(sogFiles(example))), example.rows.map(flat));
  });

  test('who takes rows hears of them while images are decoded, some of which may be damaged', async () => {
    const example = exampleOf({ count: 1, width: 1 });
    const [riffBytes, headerBytes] = [20, 5];
    const size = example.images['quats.webp'].slice(riffBytes, riffBytes + headerBytes);
    example.images['quats.webp'] = webpBytes(size);
    const layouts: RowLayout[] = [];
    const sink = {
      mayDetach: false,
      begin: async (layout: RowLayout) => void layouts.push(layout),
      memory: async () => new Uint8Array(layouts[0].pieceRows * layouts[0].strideBytes),
      take: () => expect.fail(),
    };
    const rowsTo = { sink, files: { minRows: 0, maxRows: 10, pieceBytes: 1000 } };
    const error = await fileErrorOf(
      readSource(knownSource(zipBytes(sogFiles(example))), {}, ALL_READERS, rowsTo),
    );
    expect(error).toMatchObject({ code: 'damaged', message: expect.stringContaining('quats.webp') });
    expect(layouts).toMatchObject([{ count: 1, shDegree: 1 }]);
  });

  test('progress counts the bytes of all files', async () => {
    const files = sogFiles(exampleOf());
    const reports: LoadProgress[] = [];
    await rowsOf(droppedFiles(files), { onProgress: (progress) => reports.push(progress) });
    const bytes = Object.values(files).reduce((sum, { length }) => sum + length, 0);
    expect(reports.at(-1)).toMatchObject({ loadedBytes: bytes, totalBytes: bytes, splats: 11 });
    for (const { totalBytes } of reports) expect([undefined, bytes]).toContain(totalBytes);
  });
});

describe('streamed SOG', () => {
  const first = exampleOf({ count: 9, shDegree: 2 }, 2);
  const second = exampleOf({ count: 6, shDegree: 0 }, 3);
  const coarse = exampleOf({ count: 3, shDegree: 0 }, 4);
  const sky = exampleOf({ count: 2, shDegree: 0 }, 5);
  const bound = { min: [0, 0, 0], max: [1, 1, 1] };
  const leaf = (lods: Record<string, { file: number; offset: number; count: number }>) => ({ bound, lods });
  const lodMeta = {
    version: 1,
    count: 18,
    counts: [15, 3],
    lodLevels: 2,
    filenames: ['0_0/meta.json', '1_0/meta.json', '0_1/meta.json'],
    tree: {
      bound,
      children: [
        leaf({ 0: { file: 0, offset: 0, count: 4 }, 1: { file: 1, offset: 0, count: 3 } }),
        {
          bound,
          children: [
            leaf({ 0: { file: 0, offset: 4, count: 5 } }),
            leaf({ 0: { file: 2, offset: 0, count: 6 } }),
          ],
        },
      ],
    },
  };
  /** The tree with another run in its second leaf. */
  const changedRun = (change: object, others: object = {}) => {
    const [coarse, { children }] = lodMeta.tree.children as [object, { children: ReturnType<typeof leaf>[] }];
    const changed = leaf({ 0: { ...children[0].lods[0], ...change } });
    return { ...others, tree: { bound, children: [coarse, changed, children[1]] } };
  };
  const filesOf = (meta: object): Record<string, Uint8Array<ArrayBuffer>> => ({
    ...sogFiles(second, 'scene/0_1/'),
    ...sogFiles(first, 'scene/0_0/'),
    ...sogFiles(coarse, 'scene/1_0/'),
    ...sogFiles(sky, 'scene/env/'),
    'scene/lod-meta.json': new TextEncoder().encode(JSON.stringify(meta)),
  });
  /** With zeros for harmonics that a file does not have. */
  const widened = (rows: SogExample['rows']) =>
    rows.map((row) => [...row, ...new Array(38 - row.length).fill(0)]);

  test('all files of the finest level, one after the other', async () => {
    const rows = await rowsOf(droppedFiles(filesOf(lodMeta)));
    expectRows(rows, widened([...first.rows, ...second.rows]));
    const zipped = await rowsOf(zipBytes(filesOf(lodMeta)));
    expect(zipped.values).toEqual(rows.values);
  });

  test('with its environment, and without the fields of a version', async () => {
    const { version, count, counts, ...old } = lodMeta;
    const rows = await rowsOf(droppedFiles(filesOf({ ...old, environment: 'env/meta.json' })));
    expectRows(rows, widened([...first.rows, ...second.rows, ...sky.rows]));
    expectRows(
      await rowsOf(droppedFiles(filesOf({ ...old, environment: null }))),
      widened([...first.rows, ...second.rows]),
    );
  });

  /**
   * @fault Files: a streamed SOG of which a part lacks the finest level
   * @consequence the next level is shown, and `fileFacts.notes` says of how many parts
   */
  test('where a part lacks the finest level, the next that it has, and a note', async () => {
    const rich = exampleOf({ count: 7, shDegree: 1 }, 6);
    const tree = {
      bound,
      children: [
        leaf({ 1: { file: 1, offset: 4, count: 3 } }),
        leaf({ 0: { file: 0, offset: 0, count: 9 }, 1: { file: 1, offset: 1, count: 3 } }),
        leaf({ 1: { file: 1, offset: 0, count: 1 }, 0: { file: 0, offset: 9, count: 0 } }),
        leaf({ 2: { file: 2, offset: 0, count: 6 } }),
      ],
    };
    const meta = { ...lodMeta, lodLevels: 3, count: 22, counts: [9, 7, 6], tree };
    const source = droppedFiles({ ...filesOf(meta), ...sogFiles(rich, 'scene/1_0/') });
    const rows = await rowsOf(source);
    const picked = [rich.rows[0], ...rich.rows.slice(4)];
    expectRows(rows, widened([...first.rows, ...picked, ...second.rows]));
    expect(rows.layout.fileFacts?.notes).toEqual([
      '3 of 4 parts have no splats of level 0; their next level is shown.',
    ]);
    expect(await entriesKept(source)).toBe(70 + 70 + 1);
    expect((await rowsOf(droppedFiles(filesOf(lodMeta)))).layout.fileFacts).not.toHaveProperty('notes');
  });

  test('as one palette, unless it would have too many entries', async () => {
    const source = droppedFiles(filesOf(lodMeta));
    // Files without harmonics have one entry, of zeros.
    expect(await entriesKept(source)).toBe(70 + 1);
    const large = { count: 9, shDegree: 2, width: 4, paletteSize: 2 ** 16 } as const;
    const files = { ...filesOf(lodMeta), ...sogFiles(exampleOf(large, 2), 'scene/0_0/') };
    expect(await entriesKept(droppedFiles(files))).toBeNull();
  });

  /**
   * @fault Files: a streamed SOG whose counts, runs or levels contradict one another, or leave out splats
   *   of a file
   * @consequence `SplatFileError` `damaged` that names the contradiction
   */
  test.each<[string, object, string, RegExp]>([
    ['another version', { version: 2 }, 'unknown-format', /version 2/],
    ['no tree', { tree: null }, 'bad-header', /tree/],
    ['no files', { filenames: [1] }, 'bad-header', /filenames/],
    ['no splats', { count: 0, counts: [0, 0], tree: { bound } }, 'empty', /0 splats/],
    ['a level that is not there', { lodLevels: 1 }, 'damaged', /level "1"/],
    ['a file that is not there', { filenames: ['0_0/meta.json'] }, 'damaged', /file \d/],
    [
      'a count of a file that is another',
      { filenames: ['0_1/meta.json', '', '0_0/meta.json'] },
      'damaged',
      /6 splats/,
    ],
    ['a file twice', { environment: '0_0/meta.json' }, 'damaged', /twice/],
    ['files outside', { environment: '../meta.json' }, 'damaged', /outside/],
    [
      'more than may be',
      { count: 2 ** 40, counts: [2 ** 40], tree: leaf({ 0: { file: 0, offset: 0, count: 2 ** 40 } }) },
      'too-large',
      /maxSplats|numbered/,
    ],
    ['a count of all that is another', { count: 19 }, 'damaged', /tree has 18 splats, where it says 19/],
    ['counts that are others', { counts: [14, 4] }, 'damaged', /15 splats of level 0, where it says 14/],
    ['fewer counts than levels', { counts: [15] }, 'damaged', /3 splats of level 1, where it says undefined/],
    ['more counts than levels', { counts: [15, 3, 1] }, 'damaged', /0 splats of level 2, where it says 1/],
    ['counts that are none', { counts: { 0: 15, 1: 3 } }, 'bad-header', /counts is \{0: 15, 1: 3\}/],
    ['an environment that is no name', { environment: ['env'] }, 'bad-header', /environment is \["env"\]/],
    [
      'a run beyond the end of its file',
      changedRun({ count: 6 }, { count: 19, counts: [16, 3] }),
      'damaged',
      /it has 9 splats, where the scene says 10/,
    ],
    [
      'a run that begins beyond the one before',
      changedRun({ offset: 5 }),
      'damaged',
      /0_0\/meta.json leave out splats at 4/,
    ],
    ['runs that overlap', changedRun({ offset: 3 }), 'damaged', /0_0\/meta.json overlap at 3/],
    ['a run of no place', changedRun({ offset: '4' }), 'bad-header', /lods\.0\.offset is "4"/],
    ['a file of two levels', changedRun({ file: 1, offset: 3 }), 'damaged', /levels 1 and 0/],
    ...['" "', '"0x0"', '"00"', '"-0"', '"+0"', '"0.0"', '"1e0"', '""', '"\u0660"'].map(
      (name): [string, object, string, RegExp] => [
        `a level ${name}`,
        { tree: leaf({ [JSON.parse(name)]: { file: 0, offset: 0, count: 9 } }), count: 9, counts: [9] },
        'damaged',
        /is of level ".*" in the file 0/,
      ],
    ),
    ['a version 10,000 deep', { version: deep(10_000) }, 'unknown-format', /version \[\[/],
    ['levels 10,000 deep', { lodLevels: deep(10_000) }, 'bad-header', /lodLevels is \[\[/],
    [
      'lists of children 100,000 deep',
      { tree: { bound, children: deep(100_000) } },
      'bad-header',
      /children\[0\] is \[/,
    ],
  ])('%s', async (_, change, code, message) => {
    const read = rowsOf(droppedFiles(deepened(filesOf({ ...lodMeta, ...change }))));
    await expect(read).rejects.toMatchObject({ code, message: expect.stringMatching(message) });
  });

  const readText = (text: string) =>
    rowsOf(droppedFiles({ ...filesOf(lodMeta), 'scene/lod-meta.json': new TextEncoder().encode(text) }));

  /**
   * @fault Files: metadata of SOG with any value, depth, or number of nodes, levels or files
   * @consequence splats or a `SplatFileError` whose message is short
   */
  test('a tree 100,000 nodes deep, whose message is short', async () => {
    const tree = `${'{"children":['.repeat(1e5)}{"children":7}${']}'.repeat(1e5)}`;
    const read = readText(JSON.stringify({ ...lodMeta, tree: 'deep' }).replace('"deep"', tree));
    const { code, message } = await fileErrorOf(read);
    expect(code).toBe('bad-header');
    expect(message).toMatch(/….*children\[0\]\.children is 7; it must be a list/);
    expect(message.length).toBeLessThan(700);
  });

  /**
   * @fault Files: JSON of more values than any scene has
   * @consequence `SplatFileError` `too-large`, before it is parsed
   */
  test('more values than any scene has', async () => {
    const read = readText(`{"lodLevels":1,"later":[${'0,'.repeat(2 ** 23)}0]}`);
    expect(await fileErrorOf(read)).toMatchObject({
      code: 'too-large',
      message: expect.stringMatching(/may have 8388\d+ values/),
    });
  });

  test('130,000 nodes and 130,000 levels are read', async () => {
    const coarser = Array.from({ length: 130_000 }, (_, i) => [i + 2, { file: 1, offset: 3, count: 0 }]);
    const none = leaf(Object.fromEntries(coarser));
    const children = [...new Array(130_000).fill({ bound }), ...lodMeta.tree.children, none];
    const meta = { ...lodMeta, lodLevels: 130_002, tree: { bound, children } };
    expectRows(await rowsOf(droppedFiles(filesOf(meta))), widened([...first.rows, ...second.rows]));
  });
});

describe('refuses', () => {
  test('a file that is not there', async () => {
    const example = exampleOf();
    delete example.images['quats.webp'];
    expect(await failure(example)).toMatchObject({
      code: 'missing-part',
      message: expect.stringContaining('quats.webp'),
    });
  });

  test('metadata alone', async () => {
    const { 'meta.json': meta } = sogFiles(exampleOf());
    await expect(rowsOf(meta)).rejects.toMatchObject({ code: 'missing-part' });
  });

  // biome-ignore lint/suspicious/noExplicitAny: metadata of any shape
  test.each<[string, (meta: any) => void, string, RegExp]>([
    ['version 3', (meta) => (meta.version = 3), 'unknown-format', /version 3/],
    ['no means', (meta) => delete meta.means, 'bad-header', /means is missing/],
    ['mins of two axes', (meta) => meta.means.mins.pop(), 'bad-header', /means.mins is \[-2, -0.5\]/],
    ['maxs that are text', (meta) => (meta.means.maxs[1] = '3'), 'bad-header', /means.maxs/],
    ['a short codebook', (meta) => meta.sh0.codebook.pop(), 'bad-header', /sh0.codebook.*256/],
    ['a codebook with holes', (meta) => (meta.shN.codebook[9] = null), 'bad-header', /shN.codebook/],
    ['degree 4', (meta) => (meta.shN.bands = 4), 'bad-header', /shN.bands is 4/],
    ['another degree than the palette', (meta) => (meta.shN.bands = 2), 'damaged', /192 pixels wide/],
    ['one file of two', (meta) => meta.means.files.pop(), 'bad-header', /means.files/],
    ['a file that is a number', (meta) => (meta.quats.files = [7]), 'bad-header', /quats.files is \[7\]/],
    ['half a splat', (meta) => (meta.count = 1.5), 'bad-header', /count is 1.5/],
    ['no splats', (meta) => (meta.count = 0), 'empty', /0 splats/],
    ['more splats than pixels', (meta) => (meta.count = 13), 'damaged', /4 x 3 pixels, too few for 13/],
    ['more splats than may be', (meta) => (meta.count = 2 ** 30), 'too-large', /maxSplats/],
    ['more splats than can be', (meta) => (meta.count = 2 ** 50), 'too-large', /numbered/],
    ['a palette that is smaller', (meta) => (meta.shN.count = 10), 'damaged', /palette of 10/],
    ['a file twice', (meta) => (meta.quats.files = meta.scales.files), 'damaged', /scales.webp twice/],
    [
      'a file outside',
      (meta) => (meta.quats.files = ['../quats.webp']),
      'damaged',
      /may lie outside of its folder/,
    ],
    ['a list', (meta) => (meta.quats = []), 'bad-header', /quats is \[\]/],
    [
      'a version that is an object',
      (meta) => (meta.version = { toString: 1 }),
      'unknown-format',
      /toString: 1/,
    ],
    ['a version 10,000 deep', (meta) => (meta.version = deep(10_000)), 'unknown-format', /version \[\[\[/],
    ['a count 5,000 deep', (meta) => (meta.count = deep(5000)), 'bad-header', /count is \[\[\[/],
    ['a list of files 5,000 deep', (meta) => (meta.quats.files = deep(5000)), 'bad-header', /files is \[\[/],
    ['a count that is text', (meta) => (meta.count = '11'), 'bad-header', /count is "11"/],
    [
      'a codebook of objects behind null',
      (meta) => (meta.scales.codebook = [null, ...new Array(255).fill({ valueOf: 1, toString: 1 })]),
      'bad-header',
      /scales.codebook/,
    ],
    [
      'a codebook of text behind null',
      (meta) => (meta.scales.codebook = [null, ...new Array(255).fill('1')]),
      'bad-header',
      /scales.codebook/,
    ],
  ])('%s', async (_, change, code, message) => {
    const example = exampleOf();
    change(example.meta);
    const error = await failure(example);
    expect(error.code).toBe(code);
    expect(error.message).toMatch(message);
  });

  test('version 1 without a count, or with a palette of another width', async () => {
    const example = exampleOf({ version: 1 });
    example.meta.means.shape = [];
    expect(await failure(example)).toMatchObject({ code: 'bad-header' });
    const narrow = exampleOf({ version: 1 });
    narrow.images['shN_centroids.webp'] = rgbaWebp(64, 1, new Uint8Array(256));
    expect(await failure(narrow)).toMatchObject({ code: 'damaged' });
  });

  test('no JSON', async () => {
    const { 'meta.json': meta, ...images } = sogFiles(exampleOf());
    const read = rowsOf(droppedFiles({ 'meta.json': meta.subarray(0, 900).slice(), ...images }));
    await expect(read).rejects.toMatchObject({ code: 'bad-header', message: expect.stringMatching(/JSON/) });
  });

  test.each<[string, Uint8Array<ArrayBuffer>, string, RegExp]>([
    ['a PNG', Uint8Array.of(0x89, 0x50, 0x4e, 0x47), 'unknown-format', /no WebP/],
    ['an image with losses', webpBytes(new Uint8Array(30), 'VP8 '), 'unknown-format', /lossy/],
    ['an animation', webpBytes(Uint8Array.of(2, ...new Uint8Array(9)), 'VP8X'), 'unknown-format', /animated/],
    ['a file without an image', webpBytes(new Uint8Array(4), 'EXIF'), 'damaged', /no image/],
    ['no bytes of an image', webpBytes(new Uint8Array(0)), 'damaged', /ends within its header/],
    ['an image of another size', rgbaWebp(3, 4, new Uint8Array(48)), 'damaged', /3 x 4 pixels, other images/],
  ])('%s', async (_, image, code, message) => {
    const example = exampleOf();
    example.images['sh0.webp'] = image;
    const error = await failure(example);
    expect(error.code).toBe(code);
    expect(error.message).toMatch(message);
  });

  test('an extended file is read, unless it says another size', async () => {
    const example = exampleOf();
    const image = example.images['sh0.webp'];
    const canvas = (width: number) => Uint8Array.of(0x10, 0, 0, 0, width - 1, 0, 0, 2, 0, 0);
    const extended = (width: number) => {
      const bytes = webpBytes(canvas(width), 'VP8X');
      const both = Uint8Array.from([...bytes, ...image.subarray(12)]);
      new DataView(both.buffer).setUint32(4, both.length - 8, true);
      return both;
    };
    example.images['sh0.webp'] = extended(4);
    expectRows(await rowsOf(droppedFiles(sogFiles(example))), example.rows);
    example.images['sh0.webp'] = extended(5);
    expect(await failure(example)).toMatchObject({ code: 'damaged' });
  });

  test('a rotation of no mode', async () => {
    const example = exampleOf({ count: 3, width: 2 });
    const pixels = new Uint8Array(16).fill(252);
    pixels[4 + 3] = 251;
    example.images['quats.webp'] = rgbaWebp(2, 2, pixels);
    expect(await failure(example)).toMatchObject({ code: 'damaged', place: { row: 1 } });
  });

  test('images that are truncated anywhere', async () => {
    const example = exampleOf({ count: 1, width: 1, shDegree: 0 });
    const image = example.images['means_u.webp'];
    for (let length = 0; length < image.length; length += length < 30 ? 1 : 97) {
      example.images['means_u.webp'] = image.slice(0, length);
      expect(['unknown-format', 'truncated', 'damaged']).toContain((await failure(example)).code);
    }
  });

  test('a few bytes that would unpack to a large scene', async () => {
    const side = 4096;
    const lone = { symbols: [252] } as const;
    const groups = [{ green: lone, red: lone, blue: lone, alpha: lone }];
    // No pixel takes a bit.
    const bomb = webpBytes(vp8lBytes(side, side, { items: [], groups }));
    const example = exampleOf({ shDegree: 0 });
    for (const name of Object.keys(example.images)) example.images[name] = bomb;
    example.meta.count = side * side;
    expect(await failure(example)).toMatchObject({ code: 'too-large' });
  });

  test('more bytes than are allowed', async () => {
    expect(await failure(exampleOf(), { maxBytes: 200 })).toMatchObject({ code: 'too-large' });
    const example = exampleOf({ count: 1000, shDegree: 0, width: 40 });
    const bytes = Math.max(...Object.values(sogFiles(example)).map(({ length }) => length));
    expect(await failure(example, { maxBytes: bytes + 10 })).toMatchObject({ code: 'too-large' });
  });
});

/**
 * @fault Files: a scene of XGRIDS (.lcc), USD, NumPy or PyTorch, a PNG folder of gsplat, 3D Tiles, a
 *   drawing, mesh or scan, as a file or in an archive
 */
test('the PNG folder of gsplat, from which the format came, is told by its metadata', async () => {
  const array = { shape: [9, 9], dtype: 'float32', mins: [0], maxs: [1] };
  const meta = { means: array, scales: array, quats: array, opacities: array, sh0: array, shN: array };
  const file = new File([JSON.stringify(meta)], 'meta.json');
  const image = new File([Uint8Array.of(1)], 'means_l.png');
  const error = await readSplats({ files: [file, image] }).catch((reason) => reason);
  expect(error).toMatchObject({ name: 'SplatFileError', code: 'unknown-format' });
  expect(error.message).toMatch(/PNGs by gsplat .* PLY/);
});
