import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterAll, beforeAll, describe, expect, test } from 'vitest';
import { type LeafScene, NO_ROW, type SplatCells } from '../../../data/bricks/leaf-scene.ts';
import { SplatSourceError, WebSplatterError } from '../../../data/errors.ts';
import { GEOMETRY_WORDS } from '../../../data/packing/geometry.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { fuzz } from '../../../testing/fuzz.ts';
import { piecesOf } from '../../../testing/pieces-of.ts';
import {
  type RadLayout,
  type RadNode,
  radBytes,
  radFiles,
  radOfTexts,
  randomNodes,
} from '../../../testing/rad-fixture.ts';
import { damagedBytes } from '../../../testing/read-damaged.ts';
import { droppedFiles } from '../../../testing/sog-fixture.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { knownSource } from '../../sources/known-source.ts';
import type { SplatSource } from '../../sources/splat-source.ts';
import { stackOf } from './decoded-chunk.ts';
import { openRad } from './open-rad.ts';

const nodes = randomNodes(1000, 1, true, 1, 0.4);
const layout: RadLayout = { degree: 1, chunkSize: 100, encodings: { alpha: 'f32' } };
const bytes = radBytes(nodes, layout);
const open = async (source: SplatSource = new Blob([bytes])) => (await openRad(knownSource(source)))!;

/** Splats of pieces: their rows and positions. */
function splatsOf(pieces: readonly SplatCells[]) {
  return pieces.flatMap(({ cells, geometry, fileIndices }) => {
    const positions = new Float32Array(geometry.buffer);
    const count = cells.reduce((sum, { leafCount }) => sum + leafCount, 0);
    return Array.from({ length: count }, (_, i) => {
      const at = GEOMETRY_WORDS.packed * i;
      return { row: fileIndices[i], position: [...positions.subarray(at, at + 3)] };
    });
  });
}

/** Reads both levels of every leaf, those that are found on the way as well. */
async function readAll(scene: LeafScene, order: (leafCount: number) => number = () => 0) {
  const finest: ReturnType<typeof splatsOf> = [];
  const coarsest: ReturnType<typeof splatsOf> = [];
  const left = [...scene.leaves.keys()];
  while (left.length > 0) {
    const [i] = left.splice(order(left.length), 1);
    const known = scene.leaves.length;
    const leaf = scene.leaves[i];
    const file = await scene.read(leaf.levels[0].file);
    const own = splatsOf(await piecesOf(file, leaf, leaf.levels[0]));
    finest.push(...own);
    for (let found = known; found < scene.leaves.length; found++) {
      expect(scene.leaves[found].above).toBe(i);
      left.push(found);
    }
    let count = own.length;
    for (const part of scene.leaves) {
      const isPart = part.levels.length > 1 && (part.above ?? 0) === i;
      if (!isPart) continue;
      const splats = splatsOf(await piecesOf(file, part, part.levels[1]));
      expect(splats).toHaveLength(part.levels[1].count);
      expect(splats.every(({ row }) => row === NO_ROW)).toBe(true);
      coarsest.push(...splats);
      if (part.above === i) count += splats.length;
    }
    expect(leaf.levels[0].count).toBe(count);
  }
  return { finest, coarsest };
}

describe('the leaves of a .rad', () => {
  test.each<[string, SplatSource]>([
    ['a File', new File([bytes], 'scene.rad')],
    ['memory', bytes],
    ['several files', droppedFiles(radFiles(nodes, layout, 'scene/'))],
    [
      'chunks that hold less than a family',
      radBytes(randomNodes(60, 1, true, 2), { ...layout, chunkSize: 2 }),
    ],
    ['two chunks', new Blob([radBytes(nodes, { ...layout, chunkSize: 501 })])],
    ['a palette', new Blob([radBytes(nodes, { ...layout, paletteSize: 100 })])],
  ])('of %s have its splats, each with its row in a load of the finest level', async (_, source) => {
    const whole = await readSplats(source, { name: 'scene.rad', shPrecision: 'f32' });
    const scene = await open(source);
    expect(scene.shDegree).toBe(1);
    expect(scene.splatCount).toBeGreaterThan(whole.count);
    const { finest } = await readAll(scene);
    const byRow = finest.toSorted((a, b) => a.row - b.row);
    expect(byRow.map(({ row }) => row)).toEqual([...whole.fileIndices]);
    expect(byRow.flatMap(({ position }) => position)).toEqual([...whole.positions]);
  });

  /**
   * @fault Files: a streamed scene lies far from 0
   * @consequence its splats are kept about an origin
   */
  test('of a scene far out lie about its origin, and lose nothing', async () => {
    const place = [65_536, -131_072, 4096];
    const far = nodes.map((node) => ({
      ...node,
      position: node.position.map((value, axis) => Math.fround(value + place[axis])),
    }));
    const encodings = { ...layout.encodings, center: 'f32' } as const;
    const scene = await open(new Blob([radBytes(far, { ...layout, encodings })]));
    const { finest } = await readAll(scene);
    for (let axis = 0; axis < 3; axis++) expect(Math.abs(scene.origin[axis] - place[axis])).toBeLessThan(10);
    for (const { row, position } of finest)
      expect(position.map((value, axis) => value + scene.origin[axis])).toEqual(far[row].position);
    for (const { bounds } of scene.leaves)
      if (bounds) expect(Math.max(...[...bounds.min, ...bounds.max].map(Math.abs))).toBeLessThan(30);
  });

  test('are coarse where the children of a node are in another chunk, and drawn as stacks', async () => {
    const scene = await open();
    const { coarsest } = await readAll(scene);
    const inner = [...nodes.entries()].filter(([node, { childStart, childCount }]) => {
      const chunks = [node, childStart, childStart + childCount - 1].map((each) => Math.floor(each / 100));
      return childCount > 0 && new Set(chunks).size > 1;
    });
    const expected = inner.flatMap(([, node]) => stackOf(node.alpha).opacities.map(() => node.position));
    expect(coarsest.length).toBeLessThanOrEqual(expected.length);
    const positions = new Set(expected.map(String));
    expect(coarsest.every(({ position }) => positions.has(String(position)))).toBe(true);
    expect(new Set(coarsest.map(({ position }) => String(position))).size).toBeGreaterThan(
      0.9 * positions.size,
    );
  });

  test('are the same in whatever order they are found', async () => {
    const [first, last] = [await open(), await open()];
    await readAll(first);
    await readAll(last, (count) => count - 1);
    const told = ({ leaves }: LeafScene) =>
      leaves
        .map(({ rank, bounds, levels }) => ({ rank, bounds, counts: levels.map(({ count }) => count) }))
        .sort((a, b) => a.rank! - b.rank!);
    expect(first.leaves.map(({ rank }) => rank)).not.toEqual(last.leaves.map(({ rank }) => rank));
    expect(told(first)).toEqual(told(last));
    const { leaves } = first;
    for (const { above, rank } of leaves)
      if (above !== undefined) expect(rank).toBeGreaterThan(leaves[above].rank!);
  });

  test('are told by the first chunk alone', async () => {
    const scene = await open();
    expect(scene.leaves.length).toBeGreaterThan(1);
    expect(scene.fetchedBytes).toBeLessThan(bytes.length / 6);
    const before = scene.fetchedBytes;
    const seen: number[] = [];
    await scene.read(scene.leaves[1].levels[0].file, undefined, (count) => seen.push(count));
    expect(seen.reduce((sum, count) => sum + count, 0)).toBe(scene.fetchedBytes - before);
    await scene.read(scene.leaves[1].levels[0].file);
    expect(scene.fetchedBytes).toBe(before + seen[0]);
  });

  test('are none where all is there at once, and of what is no .rad', async () => {
    expect(await openRad(knownSource(radBytes(nodes, { degree: 1 })))).toBeNull();
    expect(
      await openRad(knownSource(radBytes(randomNodes(600, 1, false), { ...layout, isTree: false }))),
    ).toBeNull();
    expect(await openRad(knownSource(new Blob(['ply\n'])))).toBeNull();
    expect(await openRad(knownSource(new Blob([bytes]).stream()))).toBeNull();
  });
});

test('stacks are drawn as Spark draws opacities above 1', () => {
  for (const opacity of [0.3, 1, 1.01, 1.1, 1.2, 1.28]) {
    const { opacities, growth } = stackOf(opacity);
    const stacked = opacity > 1 ? Math.exp(((4 * opacity - 3) ** 2 - 1) / Math.E) : 1;
    expect(opacities).toHaveLength(Math.ceil(stacked));
    expect(growth).toBeCloseTo(0, 9);
    for (let gaussian = 0.05; gaussian < 1; gaussian += 0.05) {
      const drawn = 1 - opacities.reduce((left, each) => left * (1 - each * gaussian), 1);
      const expected = opacity > 1 ? 1 - (1 - gaussian) ** stacked : opacity * gaussian;
      expect(Math.abs(drawn - expected)).toBeLessThan(0.04);
    }
  }
  // The area that n of them cover, ∫ 1 − (1 − exp(−r² / 2))ⁿ r dr, is the same.
  for (const opacity of [1.4, 1.6, 2, 3]) {
    const { opacities, growth } = stackOf(opacity);
    const covered = (count: number, scale: number) => {
      let sum = 0;
      for (let r = 0.005; r < 40; r += 0.01)
        sum += (1 - (1 - Math.exp(-((r / scale) ** 2) / 2)) ** count) * r * 0.01;
      return sum;
    };
    const stacked = Math.exp(((4 * Math.min(2, opacity) - 3) ** 2 - 1) / Math.E);
    expect(opacities).toEqual([1, 1, 1, 1]);
    expect(covered(4, Math.exp(growth)) / covered(stacked, 1)).toBeCloseTo(1, 2);
  }
});

/**
 * @fault Files: a .rad, shown by view, with a damaged header or first chunk
 * @consequence `SplatFileError` that names the place; nothing is left
 */
describe('a .rad that is read by chunks refuses', () => {
  const family = (node: number, change: Partial<RadNode>) =>
    radBytes(
      nodes.map((each, i) => (i === node ? { ...each, ...change } : each)),
      layout,
    );
  /** Nodes with children in the fourth chunk. */
  const far = [...nodes.keys()].filter((node) => node >= 300 && nodes[node].childCount > 0);
  const all = async (source: SplatSource) => readAll(await open(source));

  test.each<[string, Uint8Array<ArrayBuffer>, RegExp]>([
    ['a node that is its own child', family(1, { childStart: 1 }), /children of node 1 are 1 to/],
    [
      'a later node whose children are before it',
      family(301, { childStart: 100, childCount: 2 }),
      /node 301 are 100 to/,
    ],
    [
      'children beyond the scene',
      family(301, { childStart: 999, childCount: 2 }),
      /node 301 are 999 to 1000/,
    ],
    [
      'children with two parents',
      family(2, { childStart: nodes[1].childStart, childCount: nodes[1].childCount }),
      /has several parents|have no parent/,
    ],
    [
      'children in a far chunk with two parents',
      family(far[1], { childStart: nodes[far[0]].childStart, childCount: nodes[far[0]].childCount }),
      /has several parents|have no parent/,
    ],
    ['nodes without a parent', family(far[0], { childCount: 1 }), /have no parent/],
  ])('%s', async (_, source, says) => {
    const error = await fileErrorOf(all(new Blob([source])));
    expect(error).toMatchObject({ code: 'damaged' });
    expect(error.message).toMatch(says);
  });

  test('files that are missing or too short, when they are needed', async () => {
    const files = radFiles(nodes, layout);
    const { 'scene-lod-3.radc': _, ...rest } = files;
    const scene = await open(droppedFiles(rest));
    expect(await fileErrorOf(readAll(scene))).toMatchObject({ code: 'missing-part' });
    expect(
      await fileErrorOf(openRad(knownSource(new File([files['scene-lod.rad']], 'a.rad')))),
    ).toMatchObject({
      code: 'missing-part',
    });
    const short = { ...files, 'scene-lod-3.radc': files['scene-lod-3.radc'].slice(0, 500) };
    expect(await fileErrorOf(all(droppedFiles(short)))).toMatchObject({ code: 'damaged' });
    const outside = new TextDecoder()
      .decode(files['scene-lod.rad'].slice(8))
      .replace('scene-lod-1.radc', '../scene-lod-1.radc')
      .replace(/\0+$/, '');
    const renamed = { ...files, 'scene-lod.rad': radOfTexts(outside, []) };
    expect((await fileErrorOf(all(droppedFiles(renamed)))).message).toContain('outside');
    expect(await fileErrorOf(all(new Blob([bytes.slice(0, bytes.length - 9)])))).toMatchObject({
      code: 'truncated',
    });
  });

  /**
   * @fault Files: a chunk of a .rad is missing, damaged, or has children out of place or with several
   *   parents
   * @consequence all other parts are drawn; `stream.report()` has the error, and `retry()` tries again
   */
  test('damage of any kind, by typed errors, and never reads without end', { tags: 'deeper' }, async () => {
    const small = randomNodes(200, 1, true, 3);
    const whole = radBytes(small, { degree: 1, chunkSize: 30 });
    const plain = radBytes(small, { degree: 1, chunkSize: 30, isPacked: false });
    await fuzz({ few: 20, many: 1500 }, async (choices) => {
      const damaged = damagedBytes(choices.isTrue(0.5) ? plain : whole, choices);
      try {
        const scene = await openRad(knownSource(new Blob([damaged])));
        if (!scene) return;
        let read = 0;
        for (let i = 0; i < scene.leaves.length; i++) {
          const leaf = scene.leaves[i];
          for (const level of leaf.levels) read += splatsOf(await piecesOf(scene, leaf, level)).length;
        }
        expect(read).toBeLessThanOrEqual(5 * small.length);
      } catch (error) {
        if (!(error instanceof WebSplatterError)) throw error;
      }
    });
  });

  test('and ends when it is told to', async () => {
    const reason = new Error('enough');
    await expect(
      openRad(knownSource(new Blob([bytes])), { signal: AbortSignal.abort(reason) }),
    ).rejects.toThrow('enough');
    const scene = await open();
    await expect(scene.read(1, AbortSignal.abort(reason))).rejects.toThrow('enough');
    const abort = new AbortController();
    const reading = scene.read(1, abort.signal);
    abort.abort(reason);
    await expect(reading).rejects.toThrow('enough');
    const [leaf] = scene.leaves;
    const file = await scene.read(0);
    await expect(piecesOf(file, leaf, leaf.levels[0], AbortSignal.abort(reason))).rejects.toThrow('enough');
  });
});

describe('of an address', () => {
  const asked: string[] = [];
  let server: Server;
  let address = '';
  let tag = '"a"';
  let sendsWhole = false;
  const files: Record<string, Uint8Array<ArrayBuffer>> = {
    '/one/scene.rad': bytes,
    ...radFiles(nodes, layout, '/parts/'),
  };
  beforeAll(async () => {
    server = createServer((request, response) => {
      const { range, authorization = '' } = request.headers;
      asked.push([request.url, range, authorization].filter(Boolean).join(' '));
      const file = files[request.url!];
      const [, start, end] = /bytes=(\d+)-(\d+)/.exec(range ?? '') ?? [];
      if (sendsWhole) response.writeHead(200, { 'content-length': 2 ** 27 }).write('RAD0');
      else if (!file) response.writeHead(404).end();
      else if (start === undefined) response.writeHead(200, { 'content-length': file.length }).end(file);
      else {
        const part = file.subarray(Number(start), Number(end) + 1);
        const contentRange = `bytes ${start}-${Number(start) + part.length - 1}/${file.length}`;
        response.writeHead(206, { 'content-range': contentRange, 'content-length': part.length, etag: tag });
        response.end(part);
      }
    });
    await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
    address = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
  });
  afterAll(() => {
    server.close();
    server.closeAllConnections();
  });
  const request = { headers: { authorization: 'me' } };

  test('chunks are fetched when they are asked for, adjacent ones together, and once', async () => {
    asked.length = 0;
    const scene = (await openRad(knownSource(`${address}/one/scene.rad`), { request }))!;
    const leaves = scene.leaves.filter(({ levels }) => levels.length > 1);
    expect(asked).toHaveLength(1);
    const files = [...new Set(leaves.map(({ levels }) => levels[0].file))];
    await Promise.all([...files, ...files].map((file) => scene.read(file)));
    expect(asked.length).toBeLessThanOrEqual(2);
    expect(asked.every((each) => each.endsWith(' me'))).toBe(true);
    const local = await open();
    expect((await readAll(scene)).finest).toEqual((await readAll(local)).finest);
  });

  test('pieces are fetched from beside it', async () => {
    asked.length = 0;
    const scene = (await openRad(knownSource(`${address}/parts/scene-lod.rad`), { request }))!;
    expect(asked.map((each) => each.replace(/ bytes=\S+/, ''))).toEqual([
      '/parts/scene-lod.rad me',
      '/parts/scene-lod-0.radc me',
    ]);
    expect((await readAll(scene)).finest).toEqual((await readAll(await open())).finest);
    expect(asked).toHaveLength(1 + Math.ceil(nodes.length / 100));
  });

  test('a chunk that was damaged on the way is asked for again', async () => {
    const large = radBytes(randomNodes(6000, 3, true), { degree: 3, chunkSize: 2900, isPacked: false });
    const damaged = large.slice();
    // Behind what the first request brings.
    damaged.fill(0, large.length / 2);
    files['/one/mended.rad'] = damaged;
    const scene = (await openRad(knownSource(`${address}/one/mended.rad`)))!;
    const firstDamaged = async () => {
      for (const leaf of scene.leaves) {
        const error = await piecesOf(scene, leaf, leaf.levels[0]).catch((reason) => reason);
        if (error instanceof WebSplatterError) return { leaf, error };
      }
      throw new Error('None is damaged.');
    };
    const { leaf, error } = await firstDamaged();
    expect(error).toMatchObject({ code: 'damaged' });
    files['/one/mended.rad'] = large;
    expect(await piecesOf(scene, leaf, leaf.levels[0])).not.toHaveLength(0);
  });

  test('another version is refused, and servers without ranges send all of a large scene', async () => {
    files['/one/large.rad'] = radBytes(randomNodes(6000, 3, true), {
      degree: 3,
      chunkSize: 2900,
      isPacked: false,
    });
    const scene = (await openRad(knownSource(`${address}/one/large.rad`)))!;
    tag = '"b"';
    const { file } = scene.leaves[1].levels[0];
    await expect(scene.read(file)).rejects.toThrow(SplatSourceError);
    await expect(scene.read(file)).rejects.toThrow(/has changed/);
    sendsWhole = true;
    expect(await openRad(knownSource(`${address}/one/scene.rad`))).toBeNull();
    sendsWhole = false;
  });
});
