import { describe, expect, test } from 'vitest';
import type { Brick, BrickAddress, BrickScene } from '../../../data/bricks/brick.ts';
import { brickSceneOf } from '../../../data/bricks/make-bricks.ts';
import { SplatFileError } from '../../../data/errors.ts';
import { CHUNK_WORDS } from '../../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { setLogScales } from '../../../data/packing/chunks.ts';
import { readCoefficients, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../../../data/splats/splat-set.ts';
import { rotationMatrix } from '../../../reference/covariance.ts';
import { type ReferenceSplat, unpackSplat } from '../../../reference/packing.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { crc32 } from '../../containers/crc32.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { knownSource } from '../../sources/known-source.ts';
import {
  BRICK_HEADER,
  brickHeaderBytes,
  FILE_HEADER,
  FILE_HEADER_BYTES,
  UPPER_CELL,
} from './bricks-layout.ts';
import { encodeHarmonics } from './encode-harmonics.ts';
import { openBricks } from './open-bricks.ts';
import { write } from './write-bricks.ts';

interface Leaf extends ReferenceSplat {
  readonly sums: readonly number[];
  readonly coefficients: Float64Array;
}

function leavesOf(brick: Brick, degree: ShDegree): Leaf[] {
  const isSplat = brick.level === 0;
  const chunks = new Float32Array(brick.cells.length * CHUNK_WORDS.count);
  for (const [i, { logScales }] of brick.cells.entries())
    setLogScales(chunks, i, { min: logScales[0], step: logScales[1] });
  const wordsPerSplat = shWordsPerSplat(degree, 'u8');
  const harmonics = { degree, precision: 'u8', wordsPerSplat, words: brick.harmonics } as const;
  const floats = new Float32Array(brick.geometry.buffer);
  return brick.cells.flatMap(({ leafCount }, cell) =>
    Array.from({ length: leafCount }, (_, i) => {
      const at = cell * CHUNK_SPLATS + i;
      const geometry = { precision: isSplat ? 'packed' : 'f32', words: brick.geometry, chunks } as const;
      const coefficients = new Float64Array(coefficientsPerSplat(degree));
      readCoefficients(harmonics, at, coefficients);
      const sums = isSplat ? [] : [floats[16 * at + 11], floats[16 * at + 15]];
      return { ...unpackSplat(geometry, at), sums, coefficients };
    }),
  );
}

async function allBricks(scene: BrickScene): Promise<{ address: BrickAddress; brick: Brick }[]> {
  const bricks: { address: BrickAddress; brick: Brick }[] = [];
  const addresses = [scene.root];
  for (const address of addresses) {
    const brick = await scene.read(address);
    bricks.push({ address, brick });
    for (const { child } of brick.cells) if (child) addresses.push(child);
  }
  return bricks;
}

/** Largest difference of the covariances, by the larger of both squared sizes. */
function covarianceError(a: ReferenceSplat, b: ReferenceSplat): number {
  const [first, second] = [a, b].map(({ rotation, scale }) => {
    const r = rotationMatrix(...rotation);
    return Array.from({ length: 9 }, (_, k) =>
      [0, 1, 2].reduce(
        (sum, s) => sum + r[3 * Math.floor(k / 3) + s] * r[3 * (k % 3) + s] * scale[s] ** 2,
        0,
      ),
    );
  });
  const size = Math.max(...a.scale, ...b.scale) ** 2;
  return Math.max(...first.map((value, k) => Math.abs(value - second[k]))) / size;
}

const worst = (values: readonly number[]) => values.reduce((most, value) => Math.max(most, value), 0);
const apart = (a: ArrayLike<number>, b: ArrayLike<number>) =>
  worst(Array.from(a, (value, i) => Math.abs(value - b[i])));

describe('a file of bricks', () => {
  test.each([
    [4200, 3],
    [600, 0],
    [100, 1],
  ] as const)('%d splats of degree %d: all bricks come back, rounded', async (count, shDegree) => {
    const set = { ...randomSplats({ count, shDegree, origin: [1e6, 0, 0] }), isAntialiased: true };
    const memory = brickSceneOf(set);
    const scene = await openBricks(knownSource(await write(set, {}), { name: 'cube' }));
    const { root: _root, read: _read, end: _end, name: _name, ...facts } = memory;
    expect(scene).toMatchObject({ ...facts, name: 'cube' });
    const bricks = await allBricks(scene);
    expect(bricks.map(({ address }) => address.number)).toEqual(
      Array.from({ length: scene.brickCount }, (_, i) => i),
    );
    for (const [i, { address, brick }] of bricks.entries()) {
      const expected = await memory.read({ ...address });
      expect(brick.level).toBe(expected.level);
      expect(brick.geometry.length).toBe(expected.geometry.length);
      expect(brick.harmonics.length).toBe(expected.harmonics.length);
      for (const [k, { child, logScales, largestScale, ...cell }] of brick.cells.entries()) {
        expect(expected.cells[k]).toMatchObject(cell);
        // Rounded scales must not be beyond.
        expect(largestScale / expected.cells[k].largestScale).toBeGreaterThan(Math.exp(0.5 / 24));
        expect(largestScale / expected.cells[k].largestScale).toBeLessThan(1.03);
        expect(child?.number).toBe(expected.cells[k].child?.number);
        expect(apart(logScales, expected.cells[k].logScales)).toBeLessThan(1 / 40);
      }
      const next = bricks[i + 1]?.address;
      if (next) expect(next.offset).toBe(address.offset + address.bytes);
      const [found, made] = [leavesOf(brick, shDegree), leavesOf(expected, shDegree)];
      const errorOf = (error: (leaf: Leaf, other: Leaf) => number) =>
        worst(found.map((leaf, at) => error(leaf, made[at])));
      expect(errorOf((a, b) => apart(a.position, b.position))).toBeLessThan(2 / 2 ** 14);
      expect(errorOf((a, b) => apart(a.colorDc, b.colorDc))).toBeLessThan(0.51 / 80 + 1e-3);
      expect(errorOf((a, b) => apart(a.scale.map(Math.log), b.scale.map(Math.log)))).toBeLessThan(0.51 / 24);
      expect(errorOf((a, b) => Math.abs(a.opacity - b.opacity) / (1 + b.opacity))).toBeLessThan(0.51 / 255);
      expect(errorOf(covarianceError)).toBeLessThan(0.07);
      expect(errorOf((a, b) => apart(a.sums.map(Math.log), b.sums.map(Math.log)))).toBeLessThan(0.51 / 16);
      expect(errorOf((a, b) => apart(a.coefficients, b.coefficients))).toBeLessThan(4 / 72);
    }
    const rows = bricks.flatMap(({ brick }) =>
      brick.cells.flatMap(({ leafCount }, cell) =>
        Array.from(
          brick.fileIndices.subarray(CHUNK_SPLATS * cell).subarray(0, brick.level === 0 ? leafCount : 0),
        ),
      ),
    );
    expect(rows).toEqual(Array.from({ length: count }, (_, i) => i));
  });

  test('the whole file is read as splats, wherever they are', async () => {
    for (const origin of [
      [0, 0, 0],
      [1e6, 0, 0],
    ] as const) {
      const set = { ...randomSplats({ count: 5000, shDegree: 1, origin }), isAntialiased: false };
      const bytes = await write(set, {});
      const whole = await readSplats(bytes);
      expect(whole).toMatchObject({ count: 5000, isAntialiased: false, fileFacts: { format: 'bricks' } });
      const scene = await openBricks(knownSource(bytes));
      const leaves = (await allBricks(scene)).filter(({ brick }) => brick.level === 0);
      const [first] = leavesOf(leaves[0].brick, 1);
      const position = Array.from(
        whole.positions.subarray(0, 3),
        (value, axis) => value + whole.origin[axis] - origin[axis],
      );
      expect(apart(position, first.position)).toBeLessThan(1e-6);
      expect(whole.fileIndices).toEqual(Uint32Array.from({ length: 5000 }, (_, i) => i));
    }
  });

  test('harmonics that differ along one direction only are one component', async () => {
    const set = randomSplats({ count: 200, shDegree: 1 });
    const { coefficients } = set.harmonics;
    for (const k of coefficients.keys())
      coefficients[k] = (k % 2 ? 1 : -1) * 0.3 * Math.sin(Math.floor(k / 9));
    const scene = brickSceneOf(set);
    expect(encodeHarmonics(await scene.read(scene.root), 1)[0]).toBe(1);
  });

  test('colours, sizes and harmonics far beyond the usual are kept, coarser', async () => {
    const set = randomSplats({ count: 300, shDegree: 1 });
    set.colorDc.fill(900, 0, 1);
    set.logScales.fill(-40, 3, 6);
    set.harmonics.coefficients.fill(5000, 9, 18);
    const scene = await openBricks(knownSource(await write(set, {})));
    const [, { brick }] = await allBricks(scene);
    const leaves = leavesOf(brick, 1);
    expect(worst(leaves.flatMap(({ colorDc }) => colorDc))).toBeCloseTo(900, 0);
    expect(Math.min(...leaves.flatMap(({ scale }) => scale.map(Math.log)))).toBeCloseTo(-40, 1);
    expect(worst(leaves.flatMap(({ coefficients }) => [...coefficients])) / 5000).toBeCloseTo(1, 2);
  });

  test('an end of writing, and of reading', async () => {
    const set = randomSplats({ count: 300, shDegree: 0 });
    await expect(write(set, { signal: AbortSignal.abort('stop') })).rejects.toBe('stop');
    const scene = await openBricks(knownSource(await write(set, {})));
    await expect(scene.read(scene.root, AbortSignal.abort('stop'))).rejects.toBe('stop');
    await expect(scene.read({ ...scene.root, number: 9 })).rejects.toThrow('address.number is 9');
    await expect(openBricks(knownSource(new Blob([]).stream()))).rejects.toThrow('source is a stream');
  });
});

describe('a damaged file of bricks', () => {
  const set: SplatSet = randomSplats({ count: 1000, shDegree: 1 });
  const written = write(set, {});

  async function readAll(bytes: Uint8Array<ArrayBuffer>): Promise<void> {
    await allBricks(await openBricks(knownSource(bytes, { name: 'a.bricks' })));
  }

  /** Changes bytes, and makes both checksums of headers right again. */
  async function changed(change: (view: DataView) => void): Promise<Uint8Array<ArrayBuffer>> {
    const bytes = (await written).slice();
    const view = new DataView(bytes.buffer);
    change(view);
    view.setUint32(FILE_HEADER.crc, crc32(bytes.subarray(0, FILE_HEADER.crc)), true);
    const root = bytes.subarray(FILE_HEADER_BYTES, FILE_HEADER_BYTES + brickHeaderBytes(1, 1));
    view.setUint32(FILE_HEADER_BYTES + BRICK_HEADER.crc, crc32(root.subarray(BRICK_HEADER.number)), true);
    return bytes;
  }

  const root = FILE_HEADER_BYTES;
  const cell = root + BRICK_HEADER.cells;
  const lies: Record<string, [(view: DataView) => void, code: string, message: string]> = {
    'another file': [(view) => view.setUint8(0, 0), 'unknown-format', 'does not begin as'],
    'a later version': [(view) => view.setUint32(FILE_HEADER.version, 2, true), 'bad-header', 'of version 2'],
    'no splats': [(view) => view.setUint32(FILE_HEADER.splatCount, 0, true), 'empty', '0 splats'],
    'very many splats': [
      (view) => view.setUint32(FILE_HEADER.splatCount + 4, 9, true),
      'too-large',
      'at most 4294967295',
    ],
    'more splats than bricks': [
      (view) => view.setUint32(FILE_HEADER.splatCount, 5000, true),
      'damaged',
      'it has 2 bricks; 5000 splats make 4',
    ],
    'degree 9': [(view) => view.setUint8(FILE_HEADER.shDegree, 9), 'damaged', 'of degree 9'],
    'bounds without an end': [
      (view) => view.setFloat64(FILE_HEADER.bounds, Number.NaN, true),
      'damaged',
      'not finite',
    ],
    'bounds inside out': [
      (view) => view.setFloat64(FILE_HEADER.robustBounds, 1e9, true),
      'damaged',
      'have no inside',
    ],
    'a root beyond the end': [
      (view) => view.setUint32(FILE_HEADER.rootOffset, 1e8, true),
      'truncated',
      'brick 0 ends at byte',
    ],
    'a huge root': [
      (view) => view.setUint32(FILE_HEADER.rootBytes, 1e9, true),
      'damaged',
      'brick 0 has 1000000000',
    ],
    'another brick': [
      (view) => view.setUint32(root + BRICK_HEADER.number, 5, true),
      'damaged',
      'brick 0 says that it is brick 5',
    ],
    'parts that do not add up': [
      (view) => view.setUint32(root + BRICK_HEADER.geometryBytes, 5, true),
      'damaged',
      'brick 0 has parts of',
    ],
    'children before it': [
      (view) => view.setUint32(root + BRICK_HEADER.childrenOffset, 5, true),
      'damaged',
      'below it at byte 5, not after it',
    ],
    'a child of no bytes': [
      (view) => view.setUint32(cell + UPPER_CELL.childBytes, 0, true),
      'damaged',
      'brick 1 has 0 bytes',
    ],
    'a child beyond the end': [
      (view) => view.setUint32(cell + UPPER_CELL.childBytes, 40_000, true),
      'truncated',
      'brick 1 ends at byte',
    ],
    'an error of 0': [
      (view) => view.setUint16(cell + UPPER_CELL.childErrors, 0, true),
      'damaged',
      'has an error of 0',
    ],
    'a cell inside out': [
      (view) => view.setFloat32(cell + UPPER_CELL.bounds, 1e9, true),
      'damaged',
      'whose bounds have no inside',
    ],
    'a cell smaller than the ones below': [
      (view) => view.setFloat32(cell + UPPER_CELL.bounds, 0, true),
      'damaged',
      'brick 1 has a cell 0 that is not within',
    ],
  };
  test.each(Object.entries(lies))('%s is noticed', async (_, [change, code, message]) => {
    const error = await fileErrorOf(readAll(await changed(change)));
    expect([error.code, error.message]).toEqual([code, expect.stringContaining(message)]);
    expect(error.message).toContain('a.bricks');
  });

  test('every end is noticed, and every bit that is not right', async () => {
    const bytes = await written;
    for (let length = 0; length < bytes.length; length += 1 + Math.floor(length / 7)) {
      const short = bytes.slice(0, length);
      const { code } = await fileErrorOf(readAll(short));
      expect(['truncated', 'damaged'], `${length} bytes`).toContain(code);
      if (length > 0) await expect(readSplats(short)).rejects.toBeInstanceOf(SplatFileError);
    }
    for (let at = 0; at < bytes.length; at += 1 + Math.floor(at / 5)) {
      const wrong = bytes.slice();
      wrong[at] ^= 1 << (at % 8);
      await expect(readAll(wrong), `byte ${at}`).rejects.toBeInstanceOf(SplatFileError);
    }
  });
});
