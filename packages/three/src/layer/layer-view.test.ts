import type { EmbeddedView } from '@websplatter/core';
import { PerspectiveCamera } from 'three/webgpu';
import { expect, test, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import type { DrawnCloud } from './layer-cloud.ts';
import { LayerViews } from './layer-view.ts';

function fakeView() {
  return { destroy: vi.fn() } as unknown as EmbeddedView & { destroy: ReturnType<typeof vi.fn> };
}

const camera = new PerspectiveCamera();
const [renderer, canvas, mirror] = [{}, {}, {}];

test('views are kept by renderer, camera and target', () => {
  const views = new LayerViews();
  const use = (...place: [object, PerspectiveCamera, object]) => views.use(...place, fakeView);
  const outer = use(renderer, camera, canvas);
  const others = [
    use(renderer, camera, mirror),
    use(renderer, new PerspectiveCamera(), canvas),
    use({}, camera, canvas),
  ];
  expect(use(renderer, camera, canvas)).toBe(outer);
  expect(new Set([outer, ...others]).size).toBe(4);
});

test('finds the latest view of a renderer and camera', () => {
  const views = new LayerViews();
  expect(views.latest(renderer, camera)).toBeNull();
  views.use(renderer, camera, canvas, fakeView);
  const latest = views.use(renderer, camera, mirror, fakeView);
  expect(views.latest(renderer, camera)).toBe(latest);
});

test('finds the latest view with a cloud', () => {
  const views = new LayerViews();
  const [shown, hidden] = [new SplatCloudObject(), new SplatCloudObject()];
  for (const target of [canvas, mirror])
    views.use(renderer, camera, target, fakeView).clouds = new Map([[shown, {} as DrawnCloud]]);
  views.use(renderer, camera, {}, fakeView);
  expect(views.latestWith(shown)).toBe(views.use(renderer, camera, mirror, fakeView));
  expect(views.latestWith(hidden)).toBeNull();
});

test('views that are no longer drawn are freed, and made again if they are drawn again', () => {
  const views = new LayerViews();
  const idle = fakeView();
  const abandoned = views.use(renderer, camera, mirror, () => idle);
  for (let i = 0; i < 1000; i++) views.use(renderer, camera, canvas, fakeView);
  expect(idle.destroy).toHaveBeenCalledTimes(1);
  expect(views.use(renderer, camera, mirror, fakeView)).not.toBe(abandoned);
});

test('destroyAll frees all views', () => {
  const views = new LayerViews();
  const made = [fakeView(), fakeView()];
  views.use(renderer, camera, canvas, () => made[0]);
  views.use(renderer, camera, mirror, () => made[1]);
  views.destroyAll();
  for (const view of made) expect(view.destroy).toHaveBeenCalledTimes(1);
  expect(views.latest(renderer, camera)).toBeNull();
});

test('a texture keeps its wrapper, and another texture gets another wrapper', () => {
  const views = new LayerViews();
  const view = views.use(renderer, camera, canvas, fakeView);
  const texture = (format: GPUTextureFormat) => ({ format }) as GPUTexture;
  const [color, depth] = [texture('rgba16float'), texture('r32float')];
  const viewport = { xPx: 1, yPx: 2 };
  view.show({ color, depth }, viewport);
  const { color: first, depth: firstDepth } = view;
  const disposed = vi.fn();
  for (const wrapper of [first!, firstDepth!]) wrapper.addEventListener('dispose', disposed);
  view.show({ color, depth }, { ...viewport, xPx: 3 });
  expect([view.color, view.depth]).toEqual([first, firstDepth]);
  expect(disposed).not.toHaveBeenCalled();
  view.show({ color: texture('rgba16float'), depth: null }, viewport);
  expect(view.color).not.toBe(first);
  expect(view.depth).toBeNull();
  expect(disposed).toHaveBeenCalledTimes(2);
});
