import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import { defineEffect } from '../../gpu/effects/define-effect.ts';
import { highlight } from '../../gpu/effects/highlight/highlight.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { droppedFiles } from '../../testing/sog-fixture.ts';
import { streamedSog, streamedSogFiles } from '../../testing/streamed-sog-fixture.ts';
import type { SplatView } from '../../views/splat-view.ts';
import type { Detail } from '../plan/detail.ts';

/** Shows n/16 in place of each colour. */
const levelShown = defineEffect<undefined>({
  name: 'level-shown',
  label: 'Level',
  about: 'Shows levels.',
  hooks: { color: 'levelColor' },
  takesLevel: true,
  calledFor: () => 'levels are shown',
  wgsl: `import package::lib::packing::Splat;
fn levelColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, level: u32) -> vec3f {
  return vec3f(f32(level) / 16.0);
}`,
});

const REQUEST = {
  camera: perspectiveCamera({
    position: [0, 0, 4],
    target: [0, 0, 0],
    up: [0, 1, 0],
    fovYDegrees: 40,
    aspect: 1.5,
  }),
  widthPx: 96,
  heightPx: 64,
};

describe('the level that effects are told', () => {
  const set = randomSplats({ count: 9000, seed: 2, shDegree: 1, logScales: [-5, -3] });
  let engine: SplatEngine;
  beforeAll(async () => {
    engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: FIXED_RASTERIZER });
  });

  /** A view of all that streams. */
  function viewOf(cloud: SplatCloud) {
    const view = engine.createView();
    view.render({ ...REQUEST, clouds: [{ cloud, effects: [levelShown()] }] });
    return view;
  }

  /** Least and largest mean level of pixels that splats cover, as exactly as halves tell them. */
  async function levelsOf(cloud: SplatCloud, detail: Detail, effects = [levelShown()]) {
    const view = engine.createView();
    view.render({ ...REQUEST, clouds: [{ cloud, effects }], detail });
    const found = await shownBy(view);
    view.destroy();
    return found;
  }

  async function shownBy(view: SplatView) {
    const { data } = await view.readPixels();
    const bytes = view.effects().find(({ name }) => name === 'level-shown')?.bytes ?? 0;
    const names = engine
      .memory()
      .frames.views.flatMap(({ resources }) => resources.map(({ label }) => label));
    const pixels = Array.from({ length: data.length / 4 }, (_, i) => data.subarray(4 * i, 4 * i + 4));
    const levels = pixels.filter(([, , , a]) => a > 0.3).map(([r, , , a]) => (16 * r) / a);
    expect(levels.length).toBeGreaterThan(500);
    const range = [levels.reduce((a, b) => Math.min(a, b)), levels.reduce((a, b) => Math.max(a, b))];
    return { range: range.map((level) => Math.round(10 * level) / 10), names, bytes };
  }

  gpuTest('is that of splats and blobs of a cloud that was loaded as a whole', async () => {
    const cloud = engine.add(set);
    expect((await levelsOf(cloud, 'full')).range).toEqual([0, 0]);
    await cloud.makeLevels();
    expect((await levelsOf(cloud, 'full')).range).toEqual([0, 0]);
    // 36 chunks are below three cells, and these below one.
    expect((await levelsOf(cloud, { maxErrorPx: 1e6 })).range).toEqual([3, 3]);
    const { range, names, bytes } = await levelsOf(cloud, { maxErrorPx: 2 });
    expect(range[0]).toBeLessThan(1);
    expect(range[1]).toBeGreaterThan(range[0] + 0.3);
    expect(range[1]).toBeLessThanOrEqual(2);
    expect(names).toContain('frame chunk levels');
    // Of splats, of their blobs, and of those of all upper levels.
    expect(bytes).toBe(3 * 65_536);
    // Nothing is there for it where no effect takes it, and it may be there with a selection.
    const selection = new SplatSelection();
    const marked = highlight({ selection, color: [1, 0, 0], strength: 1 });
    expect((await levelsOf(cloud, 'full', [levelShown(), marked])).range).toEqual([0, 0]);
    expect((await levelsOf(cloud, 'full', [marked])).names).not.toContain('frame chunk levels');
    cloud.destroy();
  });

  gpuTest('is that of each of the instances, of one and of several batches', async () => {
    const cloud = engine.add(set);
    await cloud.makeLevels();
    const view = engine.createView();
    const at = (z: number) => [...new Array(12).keys()].map((i) => Number(i % 5 === 0)).concat(0, 0, z, 1);
    const rangeOf = async (places: number[], maxErrorPx: number) => {
      const instances = { modelMatrices: places.flatMap(at) };
      const clouds = [{ cloud, instances, effects: [levelShown()] }];
      view.render({ ...REQUEST, clouds, detail: { maxErrorPx } });
      return (await shownBy(view)).range;
    };
    const one = (await levelsOf(cloud, { maxErrorPx: 2 })).range;
    expect(await rangeOf([0], 2)).toEqual(one);
    // The other one is behind the camera.
    expect(await rangeOf([100, 0], 2)).toEqual(one);
    expect(await rangeOf([...new Array(250).fill(100), 0], 2)).toEqual(one);
    expect(await rangeOf([0, -0.5], 1e6)).toEqual([3, 3]);
    for (const each of [view, cloud]) each.destroy();
  });

  gpuTest('tells what stands for bricks that are missing, until they are there', async () => {
    const scene = brickSceneOf(set);
    const { when, give } = signalOf();
    const cloud = await engine.stream({
      ...scene,
      read: async (address, signal) => {
        if (address.number > 0) await when;
        return scene.read(address, signal);
      },
    });
    expect((await levelsOf(cloud, { maxErrorPx: 1e6 })).range).toEqual([3, 3]);
    const view = viewOf(cloud);
    expect((await shownBy(view)).range).toEqual([15, 15]);
    give();
    await view.whenComplete();
    expect((await shownBy(view)).range).toEqual([0, 0]);
    for (const each of [view, cloud]) each.destroy();
  });

  gpuTest('is that of leaves of a streamed SOG', async () => {
    const sog = await streamedSog({ set, filesOfLevel: [2, 1, 1], leafCount: 4 });
    const cloud = await engine.load(droppedFiles(streamedSogFiles(sog, 'scene/')));
    const { when, give } = signalOf();
    cloud.stream!.deferUploads(when);
    const { range } = await levelsOf(cloud, { maxErrorPx: 1000 });
    // The coarsest of three, with blobs of it.
    expect(range[0]).toBeGreaterThanOrEqual(2);
    expect(range[1]).toBeLessThanOrEqual(3);
    const view = viewOf(cloud);
    expect((await shownBy(view)).range).toEqual([15, 15]);
    give();
    await view.whenComplete();
    expect((await shownBy(view)).range).toEqual([0, 0]);
    for (const each of [view, cloud]) each.destroy();
  });
});
