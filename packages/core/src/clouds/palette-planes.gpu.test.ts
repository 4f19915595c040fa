import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { SplatSourceError } from '../errors.ts';
import { encodePly } from '../io/formats/ply/write-ply.ts';
import type { LoadProgress } from '../io/sources/splat-source.ts';
import { MAX_PALETTE_ENTRIES } from '../packing/harmonics-palette.ts';
import { packSet } from '../packing/pack-set.ts';
import { type CloudPrecision, SH_PRECISIONS } from '../packing/precision.ts';
import { shPlaneBytes } from '../packing/sh-plane-bytes.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { Choices } from '../testing/fuzz.ts';
import { paletteSplats, withOwnCoefficients } from '../testing/palette-splats.ts';
import { sogExample, sogFiles } from '../testing/sog-fixture.ts';
import { testCameras } from '../testing/test-cameras.ts';
import { zipBytes } from '../testing/zip-fixture.ts';
import type { SplatCloud } from './splat-cloud.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = testCameras(1).perspective;

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareBlendingDevice();
  engine = await SplatEngine.create({ device, accuracy: 'reference' });
});
afterAll(() => {
  engine?.destroy();
  device?.destroy();
});

async function imageOf(cloud: SplatCloud): Promise<Float32Array> {
  const view = engine.createView();
  view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  return data;
}

/** PSNR of an image of `cloud` against float64 of `set`, dB. */
async function psnrDb(cloud: SplatCloud, set: SplatSet): Promise<number> {
  const expected = renderReference({ clouds: [{ set }], camera: CAMERA, ...SIZE });
  return compareImages(await imageOf(cloud), expected.data, SIZE).psnrDb;
}

describe('splats with a palette', () => {
  for (const [what, options] of Object.entries({
    'one entry': { count: 600, entryCount: 1 },
    'a hundred entries, of degree 2': { count: 600, entryCount: 100, shDegree: 2 },
    'as many entries as there can be, and an odd count': { count: 601, entryCount: MAX_PALETTE_ENTRIES },
  } as const)) {
    gpuTest(`${what}: are drawn as float64 draws their rows`, async () => {
      const set = paletteSplats(options);
      // The first splat has the last entry: large and in front, so that no other will do.
      set.positions.set([0, 0, 0.9]);
      set.logScales.fill(-1.5, 0, 3);
      set.opacityLogits[0] = 3;
      const cloud = engine.add(set);
      expect(cloud.pagesFor(engine.accuracy).shPrecision).toBe('palette');
      expect(await psnrDb(cloud, withOwnCoefficients(set))).toBeGreaterThan(90);
      const { entries, degree } = set.harmonics;
      const otherwise = { ...set, harmonics: { ...set.harmonics, entries: entries.map((value) => -value) } };
      expect(await psnrDb(cloud, withOwnCoefficients(otherwise))).toBeLessThan(50);
      const { shBytes } = engine.memory().scene.clouds[0];
      expect(shBytes).toEqual({ palette: shPlaneBytes(set.count, degree, 'palette', options.entryCount) });
      cloud.destroy();
    });
  }

  gpuTest('keep it, whatever is asked for', async () => {
    const cloud = engine.add(paletteSplats({ count: 300, entryCount: 20 }));
    const before = await imageOf(cloud);
    const { bytes } = cloud;
    for (const shPrecision of SH_PRECISIONS) {
      await engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision });
      expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: SH_PRECISIONS });
      expect(cloud.pagesFor({ geometryPrecision: 'f32', shPrecision }).shPrecision).toBe('palette');
      expect(cloud.bytes).toBe(bytes);
    }
    expect(await imageOf(cloud)).toEqual(before);
    cloud.destroy();
  });

  gpuTest('keep it while their geometry is made coarser and read again', async () => {
    const cloud = engine.add(paletteSplats({ count: 300, entryCount: 20 }));
    const before = await imageOf(cloud);
    const { bytes } = cloud;
    await engine.requestPrecision(cloud, { geometryPrecision: 'packed', shPrecision: 'u8' });
    expect(cloud.bytes).toBe(bytes - 32 * 300);
    const finest: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
    await engine.requestPrecision(cloud, finest);
    expect(cloud.bytes).toBe(bytes);
    expect(await imageOf(cloud)).toEqual(before);
    cloud.destroy();
  });
});

describe('splats without a palette', () => {
  const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
  const PALETTE: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'palette' };
  // So few different harmonics that a palette has all of them.
  const set = withOwnCoefficients(paletteSplats({ count: 600, entryCount: 20 }));

  gpuTest('are given one, and have their own again', async () => {
    const cloud = engine.add(set);
    const { bytes } = cloud;
    await engine.requestPrecision(cloud, PALETTE);
    expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: ['palette'] });
    expect(bytes - cloud.bytes).toBe(600 * 180 - shPlaneBytes(600, 3, 'palette', 20));
    expect(await psnrDb(cloud, set)).toBeGreaterThan(90);
    await engine.requestPrecision(cloud, FINEST);
    expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: ['f32'] });
    cloud.destroy();
  });

  gpuTest('tell how far they are read, and then how much of a palette is found', async () => {
    const file = new Blob([encodePly(set)]);
    const cloud = await engine.load(file);
    const reports: LoadProgress[] = [];
    const onProgress = (progress: LoadProgress) => reports.push(progress);
    await engine.requestPrecision(cloud, PALETTE, { onProgress });
    const phases = [...new Set(reports.map(({ phase }) => phase))];
    expect(phases).toEqual(['read', 'arrange', 'palette']);
    expect(reports.at(-1)).toMatchObject({ loadedBytes: file.size, splats: 600, part: 1 });
    cloud.destroy();
  });

  gpuTest('stay as they are if their palette is called off while it is being found', async () => {
    const cloud = engine.add(set);
    const before = await imageOf(cloud);
    const controller = new AbortController();
    const onProgress = () => controller.abort(new Error('enough'));
    const request = engine.requestPrecision(cloud, PALETTE, { signal: controller.signal, onProgress });
    await expect(request).rejects.toThrow('enough');
    expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: ['f32'] });
    expect(await imageOf(cloud)).toEqual(before);
    cloud.destroy();
  });

  gpuTest(
    'are given one by a change of accuracy, which tells how far it is and can be called off',
    async () => {
      const other = await SplatEngine.create({ device });
      const clouds = [other.add(set), other.add(set)];
      const told = new Set<SplatCloud>();
      const controller = new AbortController();
      const calledOff = other.setAccuracy(
        { shPrecision: 'palette' },
        { signal: controller.signal, onProgress: () => controller.abort(new Error('enough')) },
      );
      expect(await calledOff).toEqual([]);
      expect(clouds.map(({ precisions }) => precisions.sh)).toEqual([['u8'], ['u8']]);
      const onProgress = ({ phase }: LoadProgress, cloud: SplatCloud) => {
        expect(phase).toBe('palette');
        told.add(cloud);
      };
      expect(await other.setAccuracy({ shPrecision: 'palette' }, { onProgress })).toEqual([]);
      expect(clouds.map(({ precisions }) => precisions.sh)).toEqual([['palette'], ['palette']]);
      expect(told).toEqual(new Set(clouds));
      other.destroy();
    },
  );

  gpuTest('of a file are given one after they were loaded', async () => {
    const other = await SplatEngine.create({ device, accuracy: { shPrecision: 'palette' } });
    const cloud = await other.load(new Blob([encodePly(set)]));
    // The claim that the load has made.
    await cloud.ownLease.met;
    expect(cloud.precisions.sh).toEqual(['palette']);
    other.destroy();
  });

  gpuTest('of a SOG are rows by default, and have its palette where they are asked to', async () => {
    const { meta, images, rows } = sogExample(
      { version: 2, count: 600, shDegree: 3, paletteSize: 90 },
      new Choices(1),
    );
    const sog = new Blob([zipBytes(sogFiles({ meta, images, rows }))]);
    const cloud = await engine.load(sog);
    expect(cloud.precisions.sh).toEqual(['f32']);
    expect(cloud.facts.paletteEntries).toBeNull();
    const before = await imageOf(cloud);
    const { bytes } = cloud;
    await engine.requestPrecision(cloud, PALETTE);
    expect(cloud.precisions.sh).toEqual(['palette']);
    expect(bytes - cloud.bytes).toBe(600 * 180 - shPlaneBytes(600, 3, 'palette', 90));
    expect(await imageOf(cloud)).toEqual(before);
    await engine.requestPrecision(cloud, FINEST);
    expect(cloud.precisions.sh).toEqual(['f32']);
    cloud.destroy();
    const kept = await engine.load(sog, { precision: PALETTE });
    expect(kept.facts.paletteEntries).toBe(90);
    expect(kept.precisions.sh).toEqual(SH_PRECISIONS);
    expect(await imageOf(kept)).toEqual(before);
    kept.destroy();
  });

  gpuTest('are given none if their source is gone', async () => {
    const cloud = engine.addPacked(packSet(set, FINEST));
    await expect(engine.requestPrecision(cloud, PALETTE)).rejects.toThrow(SplatSourceError);
    expect(cloud.precisions.sh).toEqual(['f32']);
    cloud.destroy();
  });
});
