import type { Detail, EmbeddedFrameRequest, SplatEngine } from '@websplatter/core';
import { expect, test, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { fakeEngine } from '../testing/fake-engine.ts';
import { camera, fakeRenderer, scene } from '../testing/fake-renderer.ts';
import { splatDataAt } from '../testing/test-clouds.ts';
import { layerDetail } from './layer-request.ts';
import { layersAround } from './splat-layer.ts';

const renderers = vi.hoisted(() => ({ engine: {} as SplatEngine, detail: 'full' as Detail }));
vi.mock('../renderer/adopt-renderer.ts', () => ({
  findSplatEngine: () => renderers.engine,
  splatDetailOf: () => renderers.detail,
}));

test('the finest detail that a cloud asks for is that of all', () => {
  const of = (...details: (Detail | null)[]) => layerDetail(details.map((detail) => ({ detail })));
  expect(of(null, null)).toBeNull();
  expect(of(null, { maxErrorPx: 2 }, { maxErrorPx: 0.5 })).toEqual({ maxErrorPx: 0.5 });
  expect(of({ maxErrorPx: 2 }, 'full')).toBe('full');
  expect(of({ maxSplats: 1000 }, { maxSplats: 5000 })).toEqual({ maxSplats: 5000 });
  expect(of({ maxSplats: 1000 }, { maxErrorPx: 2 })).toEqual({ maxErrorPx: 2 });
  const both = { maxErrorPx: 1, maxSplats: 1000 };
  expect(of(both, { maxSplats: 500 })).toEqual({ maxSplats: 1000 });
  expect(of(both, { maxErrorPx: 2, maxSplats: 10 })).toEqual(both);
  expect(of('auto', { maxFrameMs: 8 }, { maxFrameMs: 4 })).toEqual({ maxFrameMs: 8 });
  expect(of({ maxFrameMs: 8 }, { maxShare: 0.1 })).toEqual({ maxShare: 0.1 });
  expect(of({ maxShare: 0.9 }, { minPsnrDb: 30 }, { minPsnrDb: 40 })).toEqual({ minPsnrDb: 40 });
  expect(of('auto', 'auto')).toBe('auto');
  for (const details of [
    [{ maxSplats: 9 }, { maxShare: 0.5 }],
    [{ maxShare: 0.5 }, { maxSplats: 9 }],
  ])
    expect(of(...details)).toEqual({ maxShare: 0.5 });
  const unset = { maxFrameMs: undefined, maxSplats: 9 } as Detail;
  expect(of(unset, { maxFrameMs: 8 })).toEqual(unset);
});

test('frames have the detail of their clouds, else the renderer’s', async () => {
  const { renderer, fields } = fakeRenderer();
  fields.getMRT = () => null;
  let prepared: Detail | undefined;
  const prepare = ({ clouds, detail }: EmbeddedFrameRequest) => {
    if (clouds.length > 0) prepared = detail;
    return false;
  };
  renderers.engine = Object.assign(fakeEngine().engine, { createEmbeddedView: () => ({ prepare }) as never });
  const cloud = new SplatCloudObject(splatDataAt([0, 0, -1]));
  scene.add(cloud);
  scene.updateMatrixWorld();
  const [layer] = layersAround(cloud);
  const drawnDetail = () => {
    layer.onBeforeRender(renderer, scene, camera);
    return prepared;
  };
  // The first frames wait for the upload.
  await expect.poll(drawnDetail).toBe('full');
  renderers.detail = { maxErrorPx: 1 };
  expect(drawnDetail()).toEqual({ maxErrorPx: 1 });
  cloud.detail = { maxErrorPx: 0.25 };
  expect(drawnDetail()).toEqual({ maxErrorPx: 0.25 });
});
