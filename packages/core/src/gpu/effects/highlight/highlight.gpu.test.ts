import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { SplatSelection } from '../../../data/splats/splat-selection.ts';
import type { ReferenceFunction } from '../../../reference/effects/references.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { deviceWith } from '../../../testing/device-with.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { defineEffect } from '../define-effect.ts';
import { highlight } from './highlight.ts';

const SIZE = { widthPx: 32, heightPx: 32 };
const CAMERAS = testCameras(1);
const camera = CAMERAS.perspective;
const SET = randomSplats({ count: 700, seed: 61, shDegree: 1, logScales: [-4, -2] });
const RED = [1, 0, 0] as const;

function selectionOf(rows: readonly number[]): SplatSelection {
  const selection = new SplatSelection();
  selection.add(rows);
  return selection;
}
const marked = (selection: SplatSelection, strength = 1) => highlight({ selection, color: RED, strength });

const hide = defineEffect<SplatSelection>({
  name: 'test-hide',
  label: 'Hide',
  about: 'Hides selected splats.',
  hooks: { splat: 'hideSplat' },
  wgsl: `import package::lib::packing::Splat;
fn hideSplat(splat: Splat, splatIndex: u32, selected: bool) -> Splat {
  var hidden = splat;
  hidden.opacity = select(splat.opacity, 0.0, selected);
  return hidden;
}`,
  calledFor: () => 'selected splats are hidden',
  selection: (selection) => selection,
});
const effectReferences: Record<string, ReferenceFunction> = {
  'test-hide': (selection: SplatSelection) => ({
    changeSplat: (splat) => (selection.has(splat.row) ? { ...splat, opacity: 0 } : splat),
  }),
};

const gpu = testGpu();

describe('a highlight', () => {
  gpuTest('shows rows of the file in any storage order and on any page', async () => {
    const odd = selectionOf(Array.from({ length: 350 }, (_, i) => 2 * i + 1));
    // One is stored, the other is not.
    const two = selectionOf([699, 5000]);
    const place = [0.8, 0, 0, 0, 0, 0.8, 0, 0, 0, 0, 0.8, 0, 0.2, 0, 0, 1];
    const clouds = [
      { set: SET, effects: [marked(odd)], splatsPerPage: 256 },
      { set: SET, modelMatrix: place },
      { set: SET, modelMatrix: place, effects: [marked(two, 0.3)], splatsPerPage: 512 },
    ];
    await expectAsReference(gpu.device, { clouds, camera, ...SIZE }, 1e-4);
  });

  gpuTest('follows its selection, and holds nothing while that is empty', async () => {
    // Images are compared bit for bit: their rasteriser must not follow from times.
    const engine = await SplatEngine.create({
      device: gpu.device,
      accuracy: { preset: 'high', rasterizer: 'tiles' },
    });
    const view = engine.createView();
    const cloud = engine.add(SET);
    const selection = new SplatSelection();
    const effects = [marked(selection)];
    const frame = { camera, clouds: [{ cloud, effects }], ...SIZE };
    const draw = async () => {
      view.render(frame);
      const { data } = await view.readPixels();
      const reference = renderReference({ clouds: [{ set: SET, effects }], camera, ...SIZE });
      expect(compareImages(data, reference.data, SIZE).psnrDb).toBeGreaterThan(45);
      return data;
    };
    const labels = () => engine.memory().resources.map(({ label }) => label);

    const plain = await draw();
    expect(labels()).not.toContain('frame selections');
    selection.add(Array.from({ length: 200 }, (_, i) => i));
    const some = await draw();
    expect(some).not.toEqual(plain);
    expect(labels()).toContain('frame selections');
    expect(view.render(frame)).toBe(false);
    selection.delete([0, 1, 2, 3, 4, 5, 6, 7]);
    expect(await draw()).not.toEqual(some);
    selection.clear();
    expect(await draw()).toEqual(plain);
    expect(labels()).not.toContain('frame selections');
    engine.destroy();
  });

  gpuTest('that is requested for the first time does not hold up the camera', async () => {
    // Its engine shares no pipelines with those of the tests before.
    const fresh = deviceWith(gpu.device, {});
    const engine = await SplatEngine.create({ device: fresh, accuracy: 'high' });
    const view = engine.createView();
    const selection = new SplatSelection();
    const clouds = [{ cloud: engine.add(SET), effects: [marked(selection)] }];
    view.render({ camera, clouds, ...SIZE });
    await view.readPixels();
    selection.add([1, 2, 3]);
    const { framesPrepared } = engine.counters();
    expect(view.render({ camera: CAMERAS.inside, clouds, ...SIZE })).toBe(true);
    expect(engine.counters().framesPrepared).toBe(framesPrepared + 1);
    engine.destroy();
  });
});

gpuTest('effects of one cloud act on selections of their own, which change one by one', async () => {
  const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
  const view = engine.createView();
  const cloud = engine.add(SET);
  const [hidden, shown] = [new SplatSelection(), new SplatSelection()];
  const effects = [hide(hidden), marked(shown)];
  for (const [from, every] of [
    [0, 3],
    [1, 2],
  ]) {
    hidden.setWords(Uint32Array.of(0xffff));
    shown.clear();
    shown.add(Array.from({ length: 200 }, (_, i) => from + every * i));
    view.render({ camera, clouds: [{ cloud, effects }], ...SIZE });
    const { data } = await view.readPixels();
    const reference = renderReference({ clouds: [{ set: SET, effects }], effectReferences, camera, ...SIZE });
    expect(compareImages(data, reference.data, SIZE).psnrDb).toBeGreaterThan(60);
    const held = engine.memory().resources.find(({ label }) => label === 'frame selections');
    expect(held?.bytes).toBe(2 * 4 * Math.ceil(SET.count / 32));
  }
  engine.destroy();
});

gpuTest('effects that change splats also take the selection', async () => {
  const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
  const view = engine.createView();
  const selection = selectionOf(Array.from({ length: 350 }, (_, i) => 2 * i));
  const effects = [hide(selection), marked(selection)];
  view.render({ camera, clouds: [{ cloud: engine.add(SET), effects }], ...SIZE });
  const { data } = await view.readPixels();
  const reference = renderReference({ clouds: [{ set: SET, effects }], effectReferences, camera, ...SIZE });
  expect(compareImages(data, reference.data, SIZE).psnrDb).toBeGreaterThan(60);
  engine.destroy();
});
