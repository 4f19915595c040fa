import { readFileSync } from 'node:fs';
import { type Harmonics, readSplats, type SplatSet } from '@websplatter/core';
import { type ReferenceImage, renderReference } from '@websplatter/core/reference';
import { describe, expect, test } from 'vitest';
import { HARD_CASES } from './catalogue.ts';
import { type DeviceCase, HARD_CASE_GROUPS, type HardCloud, type SceneCase } from './hard-case.ts';
import { cameraFlaws } from './run.ts';

/** Cases whose images show nothing at all, and why. */
const EMPTY_IMAGES: Readonly<Record<string, string>> = {
  'camera-near-beyond-everything': 'every splat is nearer than the near plane',
  'viewport-0x0': 'there are no pixels',
  'viewport-0x64': 'there are no pixels',
  'counts-no-clouds': 'there are no splats',
  'counts-none-visible': 'every splat is behind the camera',
};

const scenes = HARD_CASES.filter(
  (hardCase): hardCase is SceneCase | DeviceCase => hardCase.kind === 'scene' || hardCase.kind === 'device',
);

const setOf = (cloud: HardCloud): Promise<SplatSet<Harmonics>> | SplatSet<Harmonics> =>
  'set' in cloud ? cloud.set : readSplats(cloud.file, { shPrecision: 'f32' });

async function setsOf(hardCase: SceneCase | DeviceCase) {
  return Promise.all(
    hardCase.clouds().map(async (cloud) => ({ set: await setOf(cloud), modelMatrix: cloud.modelMatrix })),
  );
}

async function imagesOf(hardCase: SceneCase | DeviceCase): Promise<ReferenceImage[]> {
  const clouds = await setsOf(hardCase);
  // Whether images are finite and show something does not depend on their size: a quarter of the usual pixels.
  const size = hardCase.size ?? { widthPx: 32, heightPx: 32 };
  // An image without pixels has no aspect ratio: any will do.
  const cameras = Object.values(hardCase.cameras(size.widthPx / size.heightPx || 1));
  return cameras.map((camera) => renderReference({ clouds, camera, ...size }));
}

describe('the catalogue of hard cases', () => {
  test('names are unique and kebab-case', () => {
    const names = HARD_CASES.map(({ name }) => name);
    expect(names.filter((name, i) => names.indexOf(name) !== i)).toEqual([]);
    expect(names.filter((name) => !/^[a-z0-9]+(-[a-z0-9]+)*$/.test(name))).toEqual([]);
  });

  test.each(['hard-cases-swiftshader', 'hard-cases-h200'])(
    'each case has its row in evidence/%s.json, in the order of the catalogue',
    (name) => {
      const file = new URL(`../../../evidence/${name}.json`, import.meta.url);
      const { tables } = JSON.parse(readFileSync(file, 'utf8')) as {
        readonly tables: readonly { readonly rows: readonly (readonly string[])[] }[];
      };
      const rows = tables.flatMap((table) => table.rows.map(([group, hardCase]) => [group, hardCase]));
      expect(rows).toEqual(HARD_CASES.map((hardCase) => [hardCase.group, hardCase.name]));
    },
  );

  test('there are at least 115 cases, some in every group, groups in their order', () => {
    expect(HARD_CASES.length).toBeGreaterThanOrEqual(115);
    const groups = HARD_CASES.map(({ group }) => group);
    expect([...new Set(groups)]).toEqual([...HARD_CASE_GROUPS]);
  });

  test('each says what breaks, in one sentence', () => {
    const wrong = HARD_CASES.filter(({ breaks }) => !/^\S[^\n]+\.$/.test(breaks));
    expect(wrong.map(({ name }) => name)).toEqual([]);
  });

  test.each(scenes.map((hardCase) => [hardCase.name, hardCase] as const))('%s', async (name, hardCase) => {
    expect(Object.keys(hardCase.cameras(1)).length).toBeGreaterThan(0);
    const images = await imagesOf(hardCase);
    for (const { data } of images) {
      expect(data.every(Number.isFinite)).toBe(true);
      expect(data.every((value) => value === 0)).toBe(name in EMPTY_IMAGES);
    }
  });

  test('reading files drops the splats that their cases state', async () => {
    for (const hardCase of scenes.filter(({ dropped }) => dropped !== undefined)) {
      const sets = await setsOf(hardCase);
      const counts: Record<string, number> = {};
      for (const { set } of sets) {
        for (const [reason, count] of Object.entries(set.dropped))
          counts[reason] = (counts[reason] ?? 0) + count;
      }
      expect(counts, hardCase.name).toEqual(hardCase.dropped);
    }
  });

  test('files that are not splats are refused with the stated code', async () => {
    for (const hardCase of HARD_CASES) {
      if (hardCase.kind !== 'refused-file') continue;
      await expect(readSplats(hardCase.file()), hardCase.name).rejects.toMatchObject({ code: hardCase.code });
    }
  });

  test('keys lie below 2^keyBits', () => {
    for (const hardCase of HARD_CASES) {
      if (hardCase.kind !== 'sort') continue;
      const limit = 2 ** hardCase.keyBits;
      expect(
        hardCase.keys().every((key) => key < limit),
        hardCase.name,
      ).toBe(true);
    }
  });

  test('first cameras have what their cases expect, of scenes of at most 4,000 splats', async () => {
    for (const hardCase of HARD_CASES) {
      if (hardCase.kind !== 'framing') continue;
      const sets = await Promise.all(hardCase.clouds().map(setOf));
      expect(
        sets.reduce((sum, { count }) => sum + count, 0),
        hardCase.name,
      ).toBeLessThanOrEqual(4000);
      for (const camera of Object.values(hardCase.cameras))
        expect(cameraFlaws(camera, hardCase.expects, camera), hardCase.name).toEqual([]);
    }
  });

  test('arithmetic holds', () => {
    for (const hardCase of HARD_CASES) {
      if (hardCase.kind === 'arithmetic') expect(hardCase.check(), hardCase.name).toBeNull();
    }
  });

  test('bounds name presets and causes', () => {
    for (const { name, bounds = {} } of scenes) {
      for (const bound of Object.values(bounds)) expect(bound.cause.length, name).toBeGreaterThan(20);
    }
  });
});
