import { readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import type { Vec3 } from '../../data/math/mat4.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { type RandomSplatOptions, randomSplats } from '../../testing/random-splats.ts';
import { readSplats } from '../loading/read-splats.ts';
import { WRITABLE_FORMATS } from './writable-formats.ts';
import { writeSplats } from './writers.ts';

const FORMATS = WRITABLE_FORMATS.map(({ name }) => name);

/** As large as an object on a table, of splats of some centimetres. */
const SCENE = { count: 300, shDegree: 0, halfExtent: 1.5, logScales: [-4, -3] } satisfies RandomSplatOptions;
const PLACES: Readonly<Record<string, Vec3>> = {
  '0': [0, 0, 0],
  '1 km': [1000.25, -1000.5, 100],
  '100 km': [100_000.25, -100_000.5, 100],
  '5,300 km': [500_000.25, 5_300_000.5, 700],
};

interface Written {
  readonly notes: readonly string[];
  /** Set that was read again, or the message of the refusal. */
  readonly set: SplatSet<{ readonly degree: 0 | 1 | 2 | 3 }> | string;
}

async function written(set: SplatSet, format: string): Promise<Written> {
  const notes: string[] = [];
  try {
    const bytes = await writeSplats(set, format, { onNote: (note) => notes.push(note) });
    return { notes, set: await readSplats(bytes, { shPrecision: 'f32' }) };
  } catch (error) {
    return { notes, set: (error as Error).message };
  }
}

/** Largest distance along an axis between a splat and the nearest one that was read. */
function largestError(set: SplatSet, found: Written['set']): number | null {
  if (typeof found === 'string') return null;
  let largest = 0;
  for (let i = 0; i < set.count; i++) {
    let nearest = Number.POSITIVE_INFINITY;
    for (let k = 0; k < found.count; k++) {
      let error = 0;
      for (let axis = 0; axis < 3; axis++) {
        const wanted = set.positions[3 * i + axis] + set.origin[axis];
        error = Math.max(error, Math.abs(found.positions[3 * k + axis] + found.origin[axis] - wanted));
      }
      nearest = Math.min(nearest, error);
    }
    largest = Math.max(largest, nearest);
  }
  return largest;
}

/** Millimetres for the table of docs/formats.md. */
function figure(error: number | null): string {
  if (error === null) return 'refused';
  return error < 1e-6 ? '0' : String(Number((1000 * error).toPrecision(1)));
}

interface Kept {
  /** `largestError` at the place; null if the writer refused. */
  readonly error: number | null;
  readonly notes: readonly string[];
  readonly refusal: string;
}

const kept = new Map<string, Promise<Kept>>();

/** What a format keeps of the scene at one of `PLACES`. */
function keptAt(format: string, place: string): Promise<Kept> {
  const measure = async () => {
    const set = randomSplats({ ...SCENE, origin: PLACES[place] });
    const { notes, set: again } = await written(set, format);
    return { notes, error: largestError(set, again), refusal: typeof again === 'string' ? again : '' };
  };
  const key = `${format} ${place}`;
  const found = kept.get(key) ?? measure();
  kept.set(key, found);
  return found;
}

describe('a scene of 3 m, written and read again', () => {
  /**
   * @fault Files: a scene far from 0 is saved as SOG or compressed PLY
   * @consequence read again in float64, it loses only the format's own steps; a note says what float32
   *   readers lose
   */
  test.each(FORMATS)('%s: at no place it loses what nothing tells', async (format) => {
    for (const place of Object.keys(PLACES)) {
      const { error, notes, refusal } = await keptAt(format, place);
      if (error === null) {
        expect(refusal).toContain('coordinates in SPZ are from -2048 to 2048');
        continue;
      }
      // A quarter of the size of a splat.
      expect(error).toBeLessThan(Math.exp(-3.5) / 4);
      // What others lose where we do not is told, too.
      const isCoarse = place === '5,300 km' && ['sog', 'compressed-ply'].includes(format);
      expect(notes, `${format} ${place}`).toHaveLength(isCoarse ? 1 : 0);
      if (isCoarse)
        expect(notes[0]).toMatch(/^other readers of .* place 300 of 300 splats in steps of 0\.5, /);
    }
  });

  test('docs/formats.md has these figures', async () => {
    const docs = readFileSync(new URL('../../../../../docs/formats.md', import.meta.url), 'utf8');
    for (const { name, title } of WRITABLE_FORMATS) {
      const errors = await Promise.all(Object.keys(PLACES).map((place) => keptAt(name, place)));
      expect(docs).toContain(`| ${title} | ${errors.map(({ error }) => figure(error)).join(' | ')} |`);
    }
  });
});

/**
 * @fault Files: a format rounds positions, sizes, colours or harmonics visibly: a stray in the same chunk,
 *   a tiny scene, bright colours
 * @consequence a note with the figure and a remedy, by `onNote`, `BrickWriter.notes`, `convert` and the
 *   viewer
 */
describe('what a format does not keep is told, with a figure and what to do', () => {
  const far: Vec3 = [500_000.25, 5_300_000.5, 700];

  test.each([
    ['sog', /^SOG places 299 of 300 splats in steps of up to 1300; .*size is 0\.03\. Crop.*$/],
    ['compressed-ply', /^compressed PLY places \d+ of 300 splats in steps of up to [0-9.e+]+; .*$/],
    ['bricks', /^\.bricks places \d+ of 300 splats in steps of up to [0-9.e+]+; .*Crop.*$/],
  ])('%s of a far scene with one failed point at 0', async (format, note) => {
    const set = randomSplats({ ...SCENE, origin: far });
    set.positions.set(
      far.map((value) => -value),
      0,
    );
    expect((await written(set, format)).notes[0]).toMatch(note);
  });

  test.each(['ply', 'gltf'])('%s keeps all but the failed point', async (format) => {
    const set = randomSplats({ ...SCENE, origin: far });
    set.positions.set(
      far.map((value) => -value),
      0,
    );
    const { notes, set: again } = await written(set, format);
    expect(notes).toEqual([]);
    const others = { ...set, count: 299, positions: set.positions.subarray(3) };
    expect(largestError(others, again)).toBeLessThan(1e-6);
  });

  test('SPZ of a tiny scene: positions, and sizes', async () => {
    const set = randomSplats({ count: 300, shDegree: 0, halfExtent: 1e-3, logScales: [-13, -12] });
    const { notes } = await written(set, 'spz');
    expect(notes).toHaveLength(2);
    expect(notes[0]).toMatch(
      /^SPZ places 300 of 300 splats in steps of up to 0\.00024; .*Scale the scene up/,
    );
    expect(notes[1]).toMatch(/^SPZ changes the sizes of 300 of 300 splats, by a factor of up to \d+\. Scale/);
  });

  test('SPZ of bright colours and of faint harmonics', async () => {
    const set = randomSplats({ count: 300, shDegree: 2 });
    for (let i = 0; i < 30; i++) set.colorDc[3 * i] = 40;
    for (let i = 0; i < set.harmonics.coefficients.length; i++) set.harmonics.coefficients[i] *= 0.15;
    const { notes } = await written(set, 'spz');
    expect(notes[0]).toMatch(
      /^SPZ changes the base colours of 30 of 300 splats, coefficients by up to 37\. /,
    );
    expect(notes[1]).toMatch(
      /^SPZ changes harmonics by 0\.02\d, as RMS of coefficients, and they are 0\.02\d\. /,
    );
    expect(notes).toHaveLength(2);
  });

  test('a splat without any size, and splats that are tiny beside others, are none', async () => {
    const set = randomSplats({ ...SCENE });
    set.logScales.fill(Number.NEGATIVE_INFINITY, 0, 3);
    set.logScales.fill(-16, 3, 90);
    expect((await written(set, 'bricks')).notes).toEqual([]);
    expect((await written(set, 'compressed-ply')).notes).toEqual([]);
  });
});
