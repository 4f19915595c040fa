import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import type { LeafScene } from '../../../data/bricks/leaf-scene.ts';
import { NO_ROW } from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError, SplatSourceError } from '../../../data/errors.ts';
import { GEOMETRY_WORDS } from '../../../data/packing/geometry.ts';
import { piecesOf } from '../../../testing/pieces-of.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { droppedFiles } from '../../../testing/sog-fixture.ts';
import { type StreamedSog, streamedSog, streamedSogFiles } from '../../../testing/streamed-sog-fixture.ts';
import { zipBytes } from '../../../testing/zip-fixture.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { knownSource } from '../../sources/known-source.ts';
import { openLeaves } from './open-leaves.ts';

const set = randomSplats({ count: 9000, seed: 4, shDegree: 1, logScales: [-6, -4] });
let sog: StreamedSog;
beforeAll(async () => {
  const environment = randomSplats({ count: 40, seed: 5, shDegree: 0 });
  sog = await streamedSog({ set, filesOfLevel: [2, 1], leafCount: 2, environment, errors: [0, 0.25] });
});

/** The scene with other metadata, or other files. */
function changed(meta: object, files: Record<string, Uint8Array<ArrayBuffer>> = {}): StreamedSog {
  return { meta: { ...sog.meta, ...meta }, files: { ...sog.files, ...files } };
}

/** The scene with its first leaf changed. */
function withLeaf(change: (leaf: StreamedSog['meta']) => void): StreamedSog {
  const meta = structuredClone(sog.meta);
  change(meta.tree.children[0].children[0]);
  return { ...sog, meta };
}

const open = async (from = sog) =>
  (await openLeaves(knownSource(droppedFiles(streamedSogFiles(from, 'scene/')))))!;

/** Reads all that there is. */
async function readAll(scene: LeafScene) {
  const all = [];
  for (const leaf of scene.leaves)
    for (const level of leaf.levels) all.push(await piecesOf(scene, leaf, level));
  return all;
}

describe('the leaves of a streamed SOG', () => {
  test('have its splats, each with its row in a load of the finest level', async () => {
    const scene = await open();
    const whole = await readSplats(droppedFiles(streamedSogFiles(sog, 'scene/')), { shPrecision: 'f32' });
    expect(scene).toMatchObject({ splatCount: whole.count, shDegree: 1, fetchedBytes: 0 });
    const rows = new Set<number>();
    const found = new Float32Array(whole.positions.length);
    let outside = 0;
    for (const leaf of scene.leaves) {
      const level = leaf.levels[0];
      for (const piece of await piecesOf(scene, leaf, level)) {
        const positions = new Float32Array(piece.geometry.buffer);
        const counts = piece.cells.map(({ leafCount }) => leafCount);
        expect(counts.slice(0, -1).every((count) => count === 256)).toBe(true);
        const count = counts.reduce((sum, each) => sum + each, 0);
        for (let i = 0; i < count; i++) {
          const at = GEOMETRY_WORDS.packed * i;
          const position = positions.subarray(at, at + 3);
          rows.add(piece.fileIndices[i]);
          found.set(position, 3 * piece.fileIndices[i]);
          const { min, max } = piece.cells[Math.floor(i / 256)].bounds;
          if (!position.every((value, axis) => min[axis] <= value && value <= max[axis])) outside++;
        }
      }
    }
    expect(outside).toBe(0);
    expect(rows.size).toBe(whole.count);
    expect(found).toEqual(whole.positions);
    const [{ levels }] = scene.leaves;
    const [coarse] = await piecesOf(scene, scene.leaves[0], levels[1]);
    expect(coarse.fileIndices[0]).toBe(NO_ROW);
    expect(scene.fetchedBytes).toBeGreaterThan(100_000);
  });

  /** @fault Files: a streamed scene lies far from 0 */
  test('of a scene far out lie about its origin', async () => {
    const origin = [2048, -4096, 1024] as const;
    const far = await streamedSog({ set: { ...set, origin }, filesOfLevel: [2, 1], leafCount: 2 });
    const source = () => droppedFiles(streamedSogFiles(far, 'scene/'));
    const whole = await readSplats(source(), { shPrecision: 'f32' });
    const scene = (await openLeaves(knownSource(source())))!;
    for (let axis = 0; axis < 3; axis++) expect(Math.abs(scene.origin[axis] - origin[axis])).toBeLessThan(1);
    let worst = 0;
    for (const leaf of scene.leaves) {
      expect(Math.max(...[...leaf.bounds!.min, ...leaf.bounds!.max].map(Math.abs))).toBeLessThan(3);
      for (const piece of await piecesOf(scene, leaf, leaf.levels[0])) {
        const positions = new Float32Array(piece.geometry.buffer);
        const count = piece.cells.reduce((sum, { leafCount }) => sum + leafCount, 0);
        for (let i = 0; i < count; i++) {
          const row = piece.fileIndices[i];
          for (let axis = 0; axis < 3; axis++) {
            const found = positions[GEOMETRY_WORDS.packed * i + axis] + scene.origin[axis];
            const expected = whole.positions[3 * row + axis] + whole.origin[axis];
            worst = Math.max(worst, Math.abs(found - expected));
          }
        }
      }
    }
    expect(worst).toBeLessThanOrEqual(2 ** -23);
  });

  test('have errors: the share of the picture that is wrong, by how far splats are apart', async () => {
    /** Errors of the coarser level in spacings of its splats: of the changed leaf, and of the other. */
    const shares = async (from: StreamedSog) => {
      const { leaves } = await open(from);
      const [first] = from.meta.tree.children[0].children[0].bound.min;
      const found = leaves.flatMap(({ bounds, levels: [finest, coarse] }) => {
        if (!bounds) return [];
        const extents = [0, 1, 2].map((axis) => bounds.max[axis] - bounds.min[axis]).sort((a, b) => b - a);
        expect(finest.error).toBe(0);
        const share = coarse.error / Math.sqrt((extents[0] * extents[1]) / coarse.count);
        return [{ share, isFirst: bounds.min[0] === first }];
      });
      return found.sort((a, b) => Number(b.isFirst) - Number(a.isFirst)).map(({ share }) => share);
    };
    expect(await shares(sog)).toEqual([expect.closeTo(0.5, 9), expect.closeTo(0.5, 9)]);
    const unknown = withLeaf((leaf) => delete leaf.errors);
    expect(await shares(unknown)).toEqual([expect.closeTo(1, 9), expect.closeTo(0.5, 9)]);
    const huge = withLeaf((leaf) => (leaf.errors = [0, 1e300]));
    expect(await shares(huge)).toEqual([expect.closeTo(1, 9), expect.closeTo(0.5, 9)]);
  });

  test('are found in an archive, and in folders', async () => {
    const expected = await readAll(await open());
    for (const isDeflated of [false, true]) {
      const archive = zipBytes(streamedSogFiles(sog, 'a/b/'), { isDeflated });
      const scene = await openLeaves(knownSource(new File([archive], 'scene.zip')));
      expect(await readAll(scene!)).toEqual(expected);
    }
    expect(await openLeaves(knownSource(new File([zipBytes(sog.files)], 'scene.sog')))).toBeNull();
  });

  test('of an archive with many files do not make Node warn of a leak', async () => {
    const others = Object.fromEntries(
      Array.from({ length: 20 }, (_, i) => [`0_0/${i}.webp`, Uint8Array.of(i)]),
    );
    const archive = new File([zipBytes(streamedSogFiles(changed({}, others)))], 'scene.zip');
    const warnings: string[] = [];
    const note = ({ message }: Error) => warnings.push(message);
    process.on('warning', note);
    const { signal } = new AbortController();
    const scene = (await openLeaves(knownSource(archive), { signal }))!;
    await Promise.all(sog.meta.filenames.map((_: string, file: number) => scene.read(file, signal)));
    // Node warns in a later task.
    await new Promise((resolve) => setImmediate(resolve));
    process.off('warning', note);
    expect(warnings).toEqual([]);
  });

  test('are left out where they have no splats, as are splats that are not finite', async () => {
    const text = new TextDecoder().decode(sog.files['0_0/meta.json']);
    const meta = JSON.parse(text);
    // Some of the rounded coordinates lie beyond float32.
    meta.means.maxs[0] = 180;
    const far = changed({}, { '0_0/meta.json': new TextEncoder().encode(JSON.stringify(meta)) });
    const from = { ...far, meta: structuredClone(far.meta) };
    for (const child of from.meta.tree.children) for (const leaf of child.children) leaf.bound.max[0] = 1e39;
    from.meta.tree.children.push(
      { bound: {}, lods: {} },
      { bound: {}, lods: { 0: { file: 0, offset: 0, count: 0 } } },
    );
    const scene = await open(from);
    expect(scene.leaves).toHaveLength(3);
    const leaf = scene.leaves.find(({ levels }) => levels[0].file === 0)!;
    const pieces = await piecesOf(scene, leaf, leaf.levels[0]);
    const count = pieces.flatMap(({ cells }) => cells).reduce((sum, { leafCount }) => sum + leafCount, 0);
    expect(count).toBeGreaterThan(100);
    expect(count).toBeLessThan(leaf.levels[0].count);
  });

  /**
   * @fault Files: a streamed SOG, shown by view, whose tree is damaged, or names files outside of its
   *   folder, or twice
   * @consequence `SplatFileError` that names the place; nothing is left
   */
  test.each<[string, () => StreamedSog, string, RegExp]>([
    ['a later version', () => changed({ version: 2 }), 'unknown-format', /version 2/],
    ['no tree', () => changed({ tree: 3 }), 'bad-header', /tree is 3/],
    ['counts that differ', () => changed({ counts: [1, 2] }), 'damaged', /where it says 1/],
    ['a path outside', () => changed({ filenames: ['../a', 'b', 'c'] }), 'damaged', /outside of its folder/],
    [
      'an address',
      () => changed({ filenames: ['https://a.b/c', 'b', 'c'] }),
      'damaged',
      /outside of its folder/,
    ],
    ['a file twice', () => changed({ filenames: ['a', 'a', 'c'] }), 'damaged', /a twice/],
    ['a file that is missing', () => changed({ filenames: ['a', 'b', 'c'] }), 'missing-part', /needs a,/],
    [
      'an environment that is missing',
      () => changed({ environment: 'e/meta.json' }),
      'missing-part',
      /e\/meta/,
    ],
    ['an environment that is none', () => changed({ environment: 7 }), 'bad-header', /environment is 7/],
    ['no bounds', () => withLeaf((leaf) => delete leaf.bound), 'bad-header', /bound is missing/],
    ['bounds inside out', () => withLeaf((leaf) => (leaf.bound.max[1] = -9)), 'bad-header', /bound\.max/],
    ['endless bounds', () => withLeaf((leaf) => (leaf.bound.max[1] = null)), 'bad-header', /bound\.max/],
    ['errors of other levels', () => withLeaf((leaf) => (leaf.errors = [0])), 'bad-header', /errors/],
    ['negative errors', () => withLeaf((leaf) => (leaf.errors = [0, -1])), 'bad-header', /errors/],
    [
      'a huge offset',
      () => withLeaf((leaf) => (leaf.lods[0].offset = 2 ** 52)),
      'damaged',
      /leave out splats/,
    ],
    ['runs that overlap', () => withLeaf((leaf) => (leaf.lods[1].count += 1)), 'damaged', /overlap/],
    [
      'a level that it has not',
      () => withLeaf((leaf) => (leaf.lods[5] = leaf.lods[1])),
      'damaged',
      /level "5"/,
    ],
    [
      'no splats',
      () => changed({ count: 0, counts: [0, 0], tree: {}, environment: null }),
      'empty',
      /0 splats/,
    ],
  ])('are not opened with %s', async (_, make, code, message) => {
    const error = await open(make()).catch((each) => each);
    expect(error).toBeInstanceOf(SplatFileError);
    expect(error.code).toBe(code);
    expect(error.message).toMatch(message);
  });

  test('of a tree of a hundred thousand levels are found', async () => {
    const meta = structuredClone(sog.meta);
    const depth = 100_000;
    const text = JSON.stringify(meta).replace(/"tree":/, `"tree":${'{"children":['.repeat(depth)}`);
    const deep = text.replace(/}$/, `${']}'.repeat(depth)}}`);
    const files = { ...streamedSogFiles(sog), 'lod-meta.json': new TextEncoder().encode(deep) };
    expect((await openLeaves(knownSource(droppedFiles(files))))!.leaves).toHaveLength(3);
  });

  /**
   * @fault Files: a file of a streamed SOG is missing, damaged, or contradicts the tree (number of splats,
   *   harmonics, bounds)
   * @consequence all other parts are drawn; `stream.report()` has the error, and `retry()` tries again
   */
  test.each<[string, () => StreamedSog, string, RegExp]>([
    [
      'bounds that its splats are not in',
      () => withLeaf((leaf) => (leaf.bound.max[0] = leaf.bound.min[0] + 0.1)),
      'damaged',
      /outside of its part of the scene/,
    ],
    [
      'the image of another',
      () => changed({}, { '0_0/quats.webp': sog.files['env/quats.webp'] }),
      'damaged',
      /pixels/,
    ],
    [
      'an image that is cut',
      () => changed({}, { '0_0/quats.webp': sog.files['0_0/quats.webp'].slice(0, 99) }),
      'truncated',
      /quats/,
    ],
    [
      'fewer splats than it says',
      () =>
        changed({}, { '0_1/meta.json': new TextEncoder().encode(metaWith('0_1', (meta) => meta.count--)) }),
      'damaged',
      /where the scene says/,
    ],
  ])('with %s cannot be read, and others can', async (_, make, code, message) => {
    const scene = await open(make());
    const results = await Promise.allSettled(
      scene.leaves.map(async (leaf) => piecesOf(scene, leaf, leaf.levels[0])),
    );
    const failed = results.flatMap((result) => (result.status === 'rejected' ? [result.reason] : []));
    expect(failed).toHaveLength(1);
    expect(failed[0]).toBeInstanceOf(SplatFileError);
    expect(failed[0].message).toMatch(message);
    expect(failed[0].code).toBe(code);
  });

  function metaWith(folder: string, change: (meta: StreamedSog['meta']) => void): string {
    const meta = JSON.parse(new TextDecoder().decode(sog.files[`${folder}/meta.json`]));
    change(meta);
    return JSON.stringify(meta);
  }
});

describe('at an address', () => {
  let server: Server;
  let address: string;
  const asked: string[] = [];
  let gone: string | null = null;
  beforeAll(async () => {
    const files = streamedSogFiles(sog, '/scene/');
    server = createServer((request, response) => {
      asked.push(`${request.url} ${request.headers.authorization ?? ''}`);
      const bytes = files[request.url!];
      if (!bytes || (gone !== null && request.url!.includes(gone))) response.writeHead(404).end();
      else response.writeHead(200, { 'content-length': bytes.length }).end(bytes);
    });
    await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
    address = `http://127.0.0.1:${(server.address() as AddressInfo).port}/scene/lod-meta.json`;
  });
  afterAll(() => {
    server.close();
    server.closeAllConnections();
  });

  test('each file is fetched when it is asked for, with the headers of the first, and kept for a while', async () => {
    const scene = (await openLeaves(knownSource(address), {
      request: { headers: { authorization: 'me' } },
    }))!;
    expect(asked).toEqual(['/scene/lod-meta.json me', '/scene/0_0/meta.json me', '/scene/env/meta.json me']);
    const leaf = scene.leaves.find(({ levels }) => levels[0].file === 1)!;
    const pieces = await piecesOf(scene, leaf, leaf.levels[0]);
    expect(asked).toHaveLength(3 + 8);
    expect(asked.slice(3).every((each) => each.startsWith('/scene/0_1/') && each.endsWith(' me'))).toBe(true);
    await scene.read(1);
    expect(asked).toHaveLength(3 + 8);
    const imageBytes = Object.entries(sog.files).filter(([path]) => /^0_1\/.*webp$/.test(path));
    expect(scene.keptBytes).toBe(imageBytes.reduce((sum, [, bytes]) => sum + bytes.length, 0));
    const dropped = await open();
    const expected = await piecesOf(
      dropped,
      dropped.leaves.find(({ levels }) => levels[0].file === 1)!,
      leaf.levels[0],
    );
    expect(pieces).toEqual(expected);
  });

  test('a file that has gone is told, and read when it is there again', async () => {
    const scene = (await openLeaves(knownSource(address)))!;
    gone = '0_1/means';
    await expect(scene.read(1)).rejects.toThrow(SplatSourceError);
    gone = null;
    await scene.read(1);
    await expect(scene.read(0, AbortSignal.abort(new Error('enough')))).rejects.toThrow('enough');
    gone = 'lod-meta';
    await expect(openLeaves(knownSource(address))).rejects.toMatchObject({ status: 404 });
    gone = null;
  });
});
