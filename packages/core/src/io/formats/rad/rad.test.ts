import { deflateRawSync } from 'node:zlib';
import { describe, expect, test } from 'vitest';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { colorOf, opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { chunked } from '../../../testing/ply-fixture.ts';
import {
  chunkBytes,
  LOG_SCALE_RANGE,
  type RadLayout,
  type RadNode,
  RGB_RANGE,
  radBytes,
  radFiles,
  radOfTexts,
  radScene,
  randomNodes,
  SH_MAX,
} from '../../../testing/rad-fixture.ts';
import { outcomeOf } from '../../../testing/read-damaged.ts';
import { droppedFiles } from '../../../testing/sog-fixture.ts';
import { zipBytes } from '../../../testing/zip-fixture.ts';
import { readSplatPieces, readSplats } from '../../loading/read-splats.ts';
import type { SplatSource } from '../../sources/splat-source.ts';

const read = (source: SplatSource) => readSplats(source, { name: 'scene.rad', shPrecision: 'f32' });

/** Nodes without children, with their places. */
const leavesOf = (nodes: readonly RadNode[]) =>
  [...nodes.entries()].filter(([, { childCount }]) => childCount === 0);

/** Half a step of floats of 16 bits from 1/2 to 1, and of those from 8 to 16. */
const HALF = 2 ** -12;
const WIDE_HALF = 2 ** -8;
const ROUNDING = 1e-6;
const RGB_STEP = (RGB_RANGE[1] - RGB_RANGE[0]) / 255;
const LOG_SCALE_STEP = (LOG_SCALE_RANGE[1] - LOG_SCALE_RANGE[0]) / 254;

/** Largest errors of a property by its encoding; of harmonics in shares of their bound. */
const BOUNDS = {
  center: { f32: 0, f16: WIDE_HALF, f32_lebytes: 0, f16_lebytes: WIDE_HALF },
  alpha: { f32: 0, f16: HALF, r8: 1 / 255 },
  rgb: { f32: 0, f16: 2 * HALF, r8: RGB_STEP / 2, r8_delta: RGB_STEP / 2 },
  scales: { f32: 0, ln_0r8: LOG_SCALE_STEP / 2, ln_f16: WIDE_HALF / 2 },
  // Of the axis, two coordinates of steps of 2/255, and the third with the errors of both, where the
  // octahedron is √3 from the sphere; and half the angle, in steps of π/255.
  orientation: { f32: 0, f16: HALF, oct88r8: (Math.sqrt(6) * Math.sqrt(3)) / 255 + Math.PI / 255 / 4 },
  sh: { f32: 0, f16: HALF, r8: 1 / 255, r8_delta: 1 / 255, s8: 0.5 / 127, s8_delta: 0.5 / 127 },
};

/** Compares what was read with its nodes, within the bounds of their encodings. */
function expectNodes(
  set: SplatSet<Harmonics>,
  nodes: readonly RadNode[],
  { degree, encodings = {}, paletteSize = nodes.length }: RadLayout,
): void {
  const usual = { center: 'f32_lebytes', alpha: 'f16', rgb: 'r8_delta', scales: 'ln_0r8' };
  const chosen: Record<string, string> = { ...usual, orientation: 'oct88r8', sh: 's8', ...encodings };
  const bound = (name: keyof typeof BOUNDS) =>
    (BOUNDS[name] as Record<string, number>)[chosen[name]] + ROUNDING;
  const leaves = leavesOf(nodes);
  expect([...set.fileIndices]).toEqual(leaves.map(([place]) => place));
  expect(set).toMatchObject({ dropped: {}, harmonics: { degree }, fileFacts: { format: 'rad' } });
  const sh = new Float64Array(coefficientsPerSplat(degree));
  const near = (found: number, expected: number, most: number) =>
    expect(Math.abs(found - expected)).toBeLessThanOrEqual(most);
  for (const [i, [place, node]] of leaves.entries()) {
    for (let k = 0; k < 3; k++) {
      near(set.positions[3 * i + k] + set.origin[k], node.position[k], bound('center'));
      near(set.logScales[3 * i + k], node.logScale[k], bound('scales'));
      near(colorOf(set.colorDc[3 * i + k]), node.rgb[k], bound('rgb'));
      near(set.rotations[4 * i + 1 + k], node.rotation[k], bound('orientation'));
    }
    // What x, y and z are off, w is off, too.
    const [w, x, y, z] = set.rotations.subarray(4 * i);
    near(w * w + x * x + y * y + z * z, 1, ROUNDING);
    near(w * w, node.rotation[3] ** 2, 4 * bound('orientation'));
    near(opacityOf(set.opacityLogits[i]), node.alpha, bound('alpha'));
    readCoefficients(set.harmonics, i, sh);
    for (const [k, value] of nodes[place % paletteSize].sh.entries()) {
      const max = SH_MAX[k < 9 ? 0 : k < 24 ? 1 : 2];
      near(sh[k], value, bound('sh') * max);
    }
  }
}

describe('reads the splats of a tree, which are its leaves', () => {
  test.each<[string, RadLayout]>([
    ['as Spark mostly writes it', { degree: 3 }],
    ['without harmonics', { degree: 0 }],
    ['of degree 1', { degree: 1 }],
    ['of degree 2', { degree: 2 }],
    [
      'in floats',
      {
        degree: 3,
        encodings: { center: 'f32', alpha: 'f32', rgb: 'f32', scales: 'f32', orientation: 'f32', sh: 'f32' },
      },
    ],
    [
      'in halves',
      {
        degree: 3,
        encodings: {
          center: 'f16',
          alpha: 'f16',
          rgb: 'f16',
          scales: 'ln_f16',
          orientation: 'f16',
          sh: 'f16',
        },
      },
    ],
    ['in bytes', { degree: 2, encodings: { center: 'f16_lebytes', alpha: 'r8', rgb: 'r8', sh: 'r8' } }],
    ['in differences of unsigned bytes', { degree: 2, encodings: { sh: 'r8_delta' } }],
    ['in differences of signed bytes', { degree: 2, encodings: { sh: 's8_delta' } }],
    ['that is not packed', { degree: 1, isPacked: false }],
    ['in chunks', { degree: 1, chunkSize: 7 }],
    ['with a palette of harmonics', { degree: 3, paletteSize: 5 }],
    [
      'with labels of 32 bits, in chunks',
      { degree: 2, paletteSize: 50, chunkSize: 20, encodings: { sh_label: 'u32' } },
    ],
  ])('%s', async (_, layout) => {
    const nodes = randomNodes(60, layout.degree, true);
    const bytes = radBytes(nodes, layout);
    const set = await read(bytes);
    expectNodes(set, nodes, layout);
    expect(await read(chunked(bytes, [100, 3000]))).toEqual(set);
  });

  test('or all nodes, where there is no tree', async () => {
    const nodes = randomNodes(50, 1, false);
    const layout: RadLayout = { degree: 1, isTree: false, chunkSize: 16 };
    const set = await read(radBytes(nodes, layout));
    expect(set.count).toBe(50);
    expectNodes(set, nodes, layout);
  });

  test('in several files, opened together or as an archive', async () => {
    const nodes = randomNodes(60, 2, true);
    const layout: RadLayout = { degree: 2, chunkSize: 16, paletteSize: 12 };
    const files = radFiles(nodes, layout, 'a/');
    expect(Object.keys(files)).toHaveLength(5);
    const set = await read(droppedFiles(files));
    expectNodes(set, nodes, layout);
    const progress: (number | undefined)[] = [];
    const zipped = await readSplats(zipBytes(files), { shPrecision: 'f32' });
    expect(zipped.positions).toEqual(set.positions);
    await readSplats(droppedFiles(files), { onProgress: ({ loadedBytes }) => progress.push(loadedBytes) });
    expect(progress.at(-1)).toBe(Object.values(files).reduce((sum, { length }) => sum + length, 0));
  });

  test('in pieces', async () => {
    const nodes = randomNodes(40_000, 0, true);
    let count = 0;
    let pieces = 0;
    await readSplatPieces(radBytes(nodes, { degree: 0, chunkSize: 16_384 }), {}, async (piece) => {
      count += piece.count;
      pieces++;
    });
    expect(count).toBe(leavesOf(nodes).length);
    expect(pieces).toBeGreaterThan(1);
  });

  test('with opacities up to 1, although rounding may take them above it', async () => {
    const nodes = randomNodes(30, 0, true).map((node) => ({ ...node, alpha: node.childCount > 0 ? 2 : 1 }));
    for (const alpha of ['r8', 'f16']) {
      const set = await read(radBytes(nodes, { degree: 0, encodings: { alpha } }));
      expect([...new Set(set.opacityLogits)]).toEqual([Number.POSITIVE_INFINITY]);
    }
  });

  test('with scales of 0, which are flat', async () => {
    const [root, ...others] = randomNodes(3, 0, false);
    const nodes = [{ ...root, logScale: [-1, Number.NEGATIVE_INFINITY, -1] }, ...others];
    for (const scales of ['f32', 'ln_0r8']) {
      const set = await read(radBytes(nodes, { degree: 0, isTree: false, encodings: { scales } }));
      expect(set.logScales[1]).toBe(-20);
    }
  });

  test('until it is told to stop', async () => {
    const bytes = radBytes(randomNodes(100, 1, true), { degree: 1, chunkSize: 10 });
    const abort = new AbortController();
    const reading = readSplats(new Blob([bytes]), { signal: abort.signal });
    abort.abort(new Error('enough'));
    await expect(reading).rejects.toThrow('enough');
  });
});

describe('refuses', () => {
  const nodes = randomNodes(40, 1, true);
  // biome-ignore lint/suspicious/noExplicitAny: tests change any part of it to anything
  type Json = Record<string, any>;

  /** The scene with its header, or one of its chunks, changed. */
  function changed(change: (header: Json, chunks: Json[]) => void, layout: Partial<RadLayout> = {}) {
    const scene = radScene(nodes, { degree: 1, chunkSize: 16, ...layout });
    const [header, jsons] = structuredClone([scene.header, scene.chunks.map(({ json }) => json)]) as [
      Json,
      Json[],
    ];
    const before = jsons.map((json) => JSON.stringify(json).length);
    const honest: Json[] = structuredClone(header.chunks);
    change(header, jsons);
    const chunks = jsons.map((json, i) => {
      // As long as it was: the header has its bytes.
      const text = JSON.stringify(json).padEnd(before[i]);
      return chunkBytes(text, scene.chunks[i].payload);
    });
    if (chunks.every(({ length }, i) => length === honest[i].bytes))
      return radOfTexts(JSON.stringify(header), chunks);
    for (let i = 0, offset = 0; i < chunks.length; offset += chunks[i++].length)
      Object.assign(header.chunks[i], { offset, bytes: chunks[i].length });
    return radOfTexts(JSON.stringify(header), chunks);
  }
  const column = (chunk: Json, name: string) =>
    chunk.properties.find(({ property }: Json) => property === name);
  const family = (node: number, change: Partial<RadNode>) =>
    radBytes(
      nodes.map((each, i) => (i === node ? { ...each, ...change } : each)),
      { degree: 1 },
    );

  test.each<[string, Uint8Array<ArrayBuffer>, string, RegExp]>([
    [
      'version 2',
      changed((header) => (header.version = 2)),
      'unknown-format',
      /version 2; version 1 is read/,
    ],
    ['other things than splats', changed((header) => (header.type = 'mesh')), 'unknown-format', /of mesh/],
    ['degree 4', changed((header) => (header.maxSh = 4)), 'bad-header', /maxSh is 4/],
    ['no nodes', changed((header) => (header.count = 0)), 'empty', /0 splats/],
    ['4 billion nodes', changed((header) => (header.count = 2 ** 32)), 'too-large', /4294967295/],
    [
      'nodes without chunks',
      changed((header) => (header.count = 4e9)),
      'damaged',
      /4000000000 nodes are in 3 chunks/,
    ],
    ['chunks of 0', changed((header) => (header.chunkSize = 0)), 'damaged', /in 3 chunks of 0/],
    [
      'fewer nodes in a chunk',
      changed((_, chunks) => (chunks[1].count = 15)),
      'damaged',
      /count is 15.*says 16/,
    ],
    [
      'chunks in another order',
      changed((_, chunks) => (chunks[1].base = 0)),
      'damaged',
      /base is 0.*says 16/,
    ],
    [
      'chunks that overlap',
      changed((header) => (header.chunks[1].offset = 0)),
      'damaged',
      /chunk 1 begins at 0/,
    ],
    [
      'more bytes than there are',
      changed((header) => (header.chunks[2].bytes = 1e12)),
      'truncated',
      /chunk 2 take/,
    ],
    [
      'a chunk of another size',
      changed((header) => (header.chunks[2].bytes -= 8)),
      'damaged',
      /chunk 2: it has .* bytes/,
    ],
    [
      'an unknown encoding',
      changed((_, chunks) => (column(chunks[0], 'center').encoding = 'f64')),
      'bad-property',
      /center is in f64; it is read in f32, f16/,
    ],
    [
      'an encoding of another property',
      changed((_, chunks) => (column(chunks[0], 'alpha').encoding = 'oct88r8')),
      'bad-property',
      /alpha is in oct88r8/,
    ],
    [
      'an unknown property',
      changed((_, chunks) => (column(chunks[0], 'alpha').property = 'normal')),
      'bad-property',
      /it has normal/,
    ],
    [
      'an unknown compression',
      changed((_, chunks) => (column(chunks[0], 'rgb').compression = 'zs')),
      'bad-property',
      /packed by zs; gz is read/,
    ],
    [
      'properties that share bytes',
      changed((_, chunks) => (column(chunks[0], 'alpha').offset = 0)),
      'damaged',
      /alpha is not where/,
    ],
    [
      'a property beyond its chunk',
      changed((_, chunks) => (column(chunks[0], 'child_start').bytes = 1e9)),
      'damaged',
      /child_start is not where/,
    ],
    [
      'columns of other lengths',
      changed((_, chunks) => (column(chunks[2], 'rgb').encoding = 'f16')),
      'damaged',
      /rgb has other than the 48 bytes of 8 rows/,
    ],
    [
      'columns that cannot be unpacked',
      changed((_, chunks) => (column(chunks[0], 'child_count').bytes -= 3)),
      'damaged',
      /cannot be unpacked|other than/,
    ],
    [
      'a missing bound',
      changed((_, chunks) => delete column(chunks[2], 'sh1').max),
      'bad-header',
      /max is missing/,
    ],
    [
      'a palette of another size',
      changed((header) => (header.shCodeCount = 5), { paletteSize: 6, isPacked: false }),
      'damaged',
      /sh1_code has other than/,
    ],
    ['a node that is its own child', family(1, { childStart: 1 }), 'damaged', /children of node 1 are 1 to/],
    ['children beyond the scene', family(1, { childStart: 39 }), 'damaged', /children of node 1 are 39 to 4/],
    [
      'children with two parents',
      family(2, { childStart: nodes[1].childStart }),
      'damaged',
      /has no parent, or the one before it has several/,
    ],
    ['nodes without a parent', family(0, { childCount: 1 }), 'damaged', /has no parent/],
  ])('%s', async (_, bytes, code, says) => {
    const before = process.memoryUsage().arrayBuffers;
    for (const source of [bytes, chunked(bytes, [500])]) {
      const error = await fileErrorOf(read(source));
      expect(error.message).toMatch(says);
      expect(error.code).toBe(code);
    }
    expect(process.memoryUsage().arrayBuffers - before).toBeLessThan(64e6);
  });

  test('labels beyond their palette', async () => {
    const { header, chunks } = radScene(nodes, { degree: 1, paletteSize: 6, isPacked: false });
    const [{ json, payload }] = chunks;
    const { offset } = column(json, 'sh_label');
    // The last node is a leaf.
    payload[offset + 2 * (nodes.length - 1)] = 6;
    const bytes = radOfTexts(JSON.stringify(header), [chunkBytes(JSON.stringify(json), payload)]);
    const error = await fileErrorOf(read(bytes));
    expect(error.message).toMatch(/the harmonics 6 of 6/);
    expect(error.code).toBe('damaged');
  });

  test('more splats than may be read, but counts no nodes above them', async () => {
    const bytes = radBytes(nodes, { degree: 1 });
    const splats = leavesOf(nodes).length;
    expect((await readSplats(bytes, { maxSplats: splats })).count).toBe(splats);
    const error = await fileErrorOf(readSplats(bytes, { maxSplats: splats - 1 }));
    expect(error.code).toBe('too-large');
  });

  test('columns that unpack to far more than their bytes', async () => {
    const count = 6_000_000;
    const zeros = new Uint8Array(deflateRawSync(new Uint8Array(12 * count)));
    const property = { offset: 0, property: 'center', encoding: 'f32', compression: 'gz' };
    const properties = [{ ...property, bytes: zeros.length }];
    const chunk = chunkBytes(JSON.stringify({ version: 1, base: 0, count, properties }), zeros);
    const chunks = [{ offset: 0, bytes: chunk.length }];
    const bytes = radOfTexts(JSON.stringify({ version: 1, type: 'gsplat', count, chunks }), [chunk]);
    expect(bytes.length).toBeLessThan(1e5);
    const error = await fileErrorOf(read(bytes));
    expect(error.message).toMatch(/unpacks to \d+ bytes or more, and 67108864 are the limit/);
    expect(error.code).toBe('too-large');
  });

  test('a scene without its other files, one that names others twice or elsewhere, and a chunk alone', async () => {
    const layout: RadLayout = { degree: 1, chunkSize: 16 };
    const files = radFiles(nodes, layout);
    const { 'scene-lod-1.radc': chunk, ...rest } = files;
    expect(await fileErrorOf(read(droppedFiles(rest)))).toMatchObject({ code: 'missing-part' });
    expect(await fileErrorOf(read(files['scene-lod.rad']))).toMatchObject({ code: 'missing-part' });
    const alone = await fileErrorOf(read(chunk));
    expect(alone).toMatchObject({ code: 'unknown-format' });
    expect(alone.message).toContain('open the .rad file');
    for (const [name, says] of [
      ['scene-lod-0.radc', 'twice'],
      ['../scene-lod-1.radc', 'outside'],
    ]) {
      const text = new TextDecoder()
        .decode(files['scene-lod.rad'].slice(8))
        .replace('scene-lod-1.radc', name);
      const renamed = { ...files, 'scene-lod.rad': radOfTexts(text.replace(/\0+$/, ''), []) };
      expect((await fileErrorOf(read(droppedFiles(renamed)))).message).toContain(says);
    }
  });

  test('every truncation', async () => {
    const bytes = radBytes(nodes, { degree: 1, chunkSize: 16 });
    for (let length = 1; length < bytes.length; length += length < 200 ? 1 : 37) {
      const outcome = await outcomeOf(bytes.slice(0, length), 'a.rad', length % 2 ? 300 : undefined);
      expect(outcome).toMatchObject({ code: length < 4 ? 'unknown-format' : 'truncated' });
    }
  });
});
