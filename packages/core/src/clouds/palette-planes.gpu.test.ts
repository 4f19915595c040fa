import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { MAX_PALETTE_ENTRIES } from '../data/packing/harmonics-palette.ts';
import { type CloudPrecision, SH_PRECISIONS } from '../data/packing/precision.ts';
import { shPlaneBytes } from '../data/packing/sh-plane-bytes.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { encodePly } from '../io/formats/ply/write-ply.ts';
import { compareImages, renderReference } from '../reference/index.ts';
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
  const set = withOwnCoefficients(paletteSplats({ count: 600, entryCount: 20 }));

  gpuTest('have bytes of their own where one is asked for', async () => {
    const cloud = engine.add(set);
    await engine.requestPrecision(cloud, PALETTE);
    expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: ['u8'] });
    const other = await SplatEngine.create({ device, accuracy: { shPrecision: 'palette' } });
    const loaded = await other.load(new Blob([encodePly(set)]));
    expect(loaded.precisions.sh).toEqual(['u8']);
    other.destroy();
    cloud.destroy();
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
});
