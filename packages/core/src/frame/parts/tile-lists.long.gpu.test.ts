// Proves: if pairs find no memory, quads draw the frame; lists are freed.
import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { createEngine, type SplatEngine } from '../../create-engine.ts';
import { type Camera, orthographicCamera } from '../../data/camera/camera.ts';
import type { EngineOptions, EngineSeams } from '../../engine.ts';
import { renderReference } from '../../reference/render.ts';
import { compareImages } from '../../stages/measure/measure.reference.ts';
import { splatsOf } from '../../testing/random-splats.ts';
import type { SplatView } from '../../views/splat-view.ts';
import type { FrameRequest } from '../plan/frame-request.ts';
import { PAIR_BYTES } from './pair-capacity.ts';

/** A row of 64 bins. */
const SIZE = { widthPx: 4096, heightPx: 1 };
const CAMERA = orthographicCamera({ position: [0, 0, 3], target: [0, 0, 0], aspect: 4096, height: 2 });
/**
 * Each splat covers every bin. Room is made for 16,384 pairs at first: for more than one pair per
 * splat, for fewer than 64.
 */
const COVERING = splatsOf(
  Array.from({ length: 300 }, (_, i) => ({
    position: [0, 0, i / 300],
    logScales: [12, 12, -3],
    opacityLogit: -4,
    colorDc: [Math.sin(i), Math.cos(i), i / 300],
  })),
);
const PAIRS = 300 * 64;

/** Mutations that make one rasteriser draw nothing: an image shows which one drew it. */
const BLIND = {
  quads: {
    file: 'stages/rasterize',
    find: 'fragment.color = vec4f(color.rgb * alpha, alpha);',
    replace: 'fragment.color = 0.0 * vec4f(color.rgb * alpha, alpha);',
  },
  tiles: {
    file: 'lib/tile-blend',
    find: 'rounded(vec4f(pixel.color, 1.0 - pixel.transmittance))',
    replace: '0.0 * vec4f(pixel.color, 1.0 - pixel.transmittance)',
  },
} as const;

let device: GPUDevice;
let reference: Float64Array;
beforeAll(async () => {
  // Quads that blend 300 layers in halves may lose more than the tests allow.
  device = await shareBlendingDevice();
  reference = renderReference({ clouds: [{ set: COVERING }], camera: CAMERA, ...SIZE }).data;
});

/** An engine with one view of the covering splats. */
async function stageWith({
  tileBudgetBytes,
  mutation,
}: Pick<EngineOptions & EngineSeams, 'tileBudgetBytes' | 'mutation'> = {}) {
  const accuracy = { preset: 'reference', rasterizer: 'tiles' } as const;
  const engine = await createEngine({ device, accuracy, tileBudgetBytes }, { mutation });
  const cloud = engine.add(COVERING);
  const view = engine.createView();
  const draw = async (request: Partial<FrameRequest> = {}) => {
    view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE, ...request });
    return (await view.readPixels()).data;
  };
  return { engine, cloud, view, draw };
}

/** Draws, and waits until the frame's statistics have arrived. */
async function measured(view: SplatView, draw: () => Promise<Float32Array>): Promise<Float32Array> {
  const before = view.statistics?.frame ?? 0;
  const data = await draw();
  await expect.poll(() => view.statistics?.frame).toBeGreaterThan(before);
  return data;
}

const isEmpty = (data: Float32Array) => data.every((value) => value === 0);
const isSame = (a: Float32Array, b: Float32Array) =>
  Buffer.compare(Buffer.from(a.buffer), Buffer.from(b.buffer)) === 0;
const isComplete = (data: Float32Array) => compareImages(data, reference, SIZE).psnrDb > 45;

function tileBytes(engine: SplatEngine): number {
  return engine
    .memory()
    .resources.filter(({ label }) => label.startsWith('tiles '))
    .reduce((sum, { bytes }) => sum + bytes, 0);
}

describe('pairs of a frame', () => {
  gpuTest(
    'that find no room make the image one bin in this very frame, and the next one has room',
    async () => {
      const { engine, view, draw } = await stageWith({ mutation: BLIND.quads });
      const first = await measured(view, draw);
      expect(view.statistics).toMatchObject({ tilePairs: PAIRS, rasterizer: 'tiles' });
      const before = tileBytes(engine);
      const second = await measured(view, () => draw({ force: true }));
      expect(tileBytes(engine)).toBeGreaterThan(before);
      expect(isComplete(first)).toBe(true);
      expect(isSame(first, second)).toBe(true);
      engine.destroy();
    },
  );

  gpuTest('that exceed the budget make the image one bin in every frame', async () => {
    const roomy = await stageWith();
    await measured(roomy.view, roomy.draw);
    const expected = await roomy.draw({ force: true });
    roomy.engine.destroy();
    // Room for all pairs but one group, and for one group.
    for (const pairs of [PAIRS - 256, 512]) {
      const tileBudgetBytes = pairs * PAIR_BYTES;
      const { engine, view, draw } = await stageWith({ tileBudgetBytes, mutation: BLIND.quads });
      for (let i = 0; i < 3; i++)
        expect(isSame(await measured(view, () => draw({ force: true })), expected)).toBe(true);
      expect(tileBytes(engine)).toBeLessThan(1.2 * tileBudgetBytes + 20_000);
      engine.destroy();
    }
  });

  gpuTest('are drawn by quads where there is no room for the visible splats', async () => {
    for (const tileBudgetBytes of [256 * PAIR_BYTES, 0]) {
      const { engine, view, draw } = await stageWith({ tileBudgetBytes, mutation: BLIND.tiles });
      for (let i = 0; i < 2; i++)
        expect(isComplete(await measured(view, () => draw({ force: true })))).toBe(true);
      const drawn = await draw({ force: true });
      const quads = await draw({ accuracy: { preset: 'reference', rasterizer: 'quads' } });
      expect(isSame(drawn, quads)).toBe(true);
      engine.destroy();
    }
  });

  gpuTest('have as much room after a frame of nothing as before it', async () => {
    const { engine, view, draw } = await stageWith();
    await measured(view, draw);
    await draw({ force: true });
    const before = tileBytes(engine);
    expect(isEmpty(await measured(view, () => draw({ clouds: [] })))).toBe(true);
    expect(isComplete(await measured(view, draw))).toBe(true);
    expect(tileBytes(engine)).toBeLessThanOrEqual(before);
    engine.destroy();
  });

  gpuTest(
    'fit again after fewer of them and more of them, in the room that was needed a moment ago',
    async () => {
      const { engine, view, draw } = await stageWith({ mutation: BLIND.quads });
      // Among the splats: about half of them are behind it.
      const amid: Camera = orthographicCamera({
        position: [0, 0, 0.5],
        target: [0, 0, 0],
        aspect: 4096,
        height: 2,
      });
      const bytes: number[] = [];
      for (const camera of [CAMERA, amid, CAMERA]) {
        await measured(view, () => draw({ camera }));
        const data = await draw({ camera, force: true });
        const reference = renderReference({ clouds: [{ set: COVERING }], camera, ...SIZE });
        expect(reference.visibleSplats).toBeGreaterThan(100);
        expect(compareImages(data, reference.data, SIZE).psnrDb).toBeGreaterThan(45);
        bytes.push(tileBytes(engine));
      }
      expect(bytes).toEqual([bytes[0], bytes[0], bytes[0]]);
      engine.destroy();
    },
  );

  gpuTest('fit again after another size', async () => {
    const { engine, view, draw } = await stageWith({ mutation: BLIND.quads });
    for (const [widthPx, heightPx] of [
      [4096, 1],
      [64, 64],
      [65, 70],
      [63, 1],
      [4096, 1],
    ]) {
      const request = { widthPx, heightPx };
      await measured(view, () => draw(request));
      const data = await draw({ ...request, force: true });
      const reference = renderReference({ clouds: [{ set: COVERING }], camera: CAMERA, ...request });
      expect(compareImages(data, reference.data, request).psnrDb, `${widthPx}×${heightPx}`).toBeGreaterThan(
        45,
      );
    }
    engine.destroy();
  });

  gpuTest('leave no memory behind them', async () => {
    const { engine, cloud, view, draw } = await stageWith();
    await measured(view, draw);
    expect(tileBytes(engine)).toBeGreaterThan(0);
    view.destroy();
    cloud.destroy();
    await device.queue.onSubmittedWorkDone();
    await expect.poll(() => engine.memory().totalBytes).toBe(0);
    engine.destroy();
  });
});

describe('a rasteriser', () => {
  gpuTest('may change with every frame though the camera stands still', async () => {
    const drawing = {
      quads: await stageWith({ mutation: BLIND.tiles }),
      tiles: await stageWith({ mutation: BLIND.quads }),
    };
    const rasterizers = ['quads', 'tiles', 'tiles', 'quads'] as const;
    for (const { view, draw } of Object.values(drawing)) await measured(view, draw);
    for (const rasterizer of rasterizers) {
      const other = rasterizer === 'tiles' ? 'quads' : 'tiles';
      const request = { accuracy: { preset: 'reference', rasterizer }, force: true } as const;
      // The first frame after a change may lack room, as the first of all.
      for (const stage of Object.values(drawing)) await measured(stage.view, () => stage.draw(request));
      expect(isComplete(await drawing[rasterizer].draw(request))).toBe(true);
      expect(isEmpty(await drawing[other].draw(request))).toBe(true);
    }
    for (const { engine } of Object.values(drawing)) engine.destroy();
  });

  gpuTest('holds no lists where quads draw, and frees them when quads take over', async () => {
    const { engine, view, draw } = await stageWith();
    const quads = { accuracy: { preset: 'reference', rasterizer: 'quads' } } as const;
    expect(isComplete(await draw(quads))).toBe(true);
    expect(tileBytes(engine)).toBe(0);
    const before = engine.memory().totalBytes;
    expect(isComplete(await measured(view, draw))).toBe(true);
    expect(tileBytes(engine)).toBeGreaterThan(PAIR_BYTES * 16_384 * 0.3);
    expect(isComplete(await draw(quads))).toBe(true);
    expect(tileBytes(engine)).toBe(0);
    expect(engine.memory().totalBytes).toBe(before);
    engine.destroy();
  });
});
