import type { FrameRequest, SplatEngine } from '@websplatter/core';
import { expect, it, vi } from 'vitest';
import type { Viewer } from '../engine/viewer.ts';
import { createViewerStore } from '../state/store.ts';
import type { MapModeName } from '../state/view-mode.ts';
import { showMap } from './show-map.ts';

const IMAGE = { widthPx: 1, heightPx: 1, data: new Uint8ClampedArray(4) };

function setUp() {
  const store = createViewerStore();
  store.setState({ status: 'running', viewMode: 'tile-cost', isIdle: true, restedFrames: 1 });
  const canvas = { hidden: false, getContext: () => null } as unknown as HTMLCanvasElement;
  const shownFrame = { engine: {} as SplatEngine, frame: {} as FrameRequest };
  const asked: { mode: MapModeName; give: (unseen: number) => void; refuse: (error: Error) => void }[] = [];
  const makeMap = vi.fn(
    (mode: MapModeName) =>
      new Promise<never>((resolve, reject) => {
        const give = (unseen: number) =>
          resolve({
            ...IMAGE,
            figures: { mode, restedFrames: 1, kind: 'contribution', splats: 9, unseen },
          } as never);
        asked.push({ mode, give, refuse: reject });
      }),
  );
  vi.stubGlobal('ImageData', class {});
  const stop = showMap(canvas, { shownFrame } as unknown as Viewer, store, makeMap);
  const unseen = () => {
    const { mapFigures } = store.getState();
    return mapFigures?.kind === 'contribution' ? mapFigures.unseen : null;
  };
  return { store, canvas, asked, stop, unseen };
}

it('counts the picture at rest, hides the map while it moves, and keeps its figures', async () => {
  const { store, canvas, asked, stop, unseen } = setUp();
  expect(canvas.hidden).toBe(true);
  asked[0].give(4);
  await expect.poll(unseen).toBe(4);
  expect(canvas.hidden).toBe(false);

  store.setState({ isIdle: false });
  expect(canvas.hidden).toBe(true);
  expect(unseen()).toBe(4);
  // Nothing was drawn: the picture is still the one that was counted.
  store.setState({ isIdle: true });
  expect(canvas.hidden).toBe(false);
  expect(asked.length).toBe(1);
  store.setState({ isIdle: false });
  store.setState({ isIdle: true, restedFrames: 2 });
  expect(asked.length).toBe(2);
  asked[1].give(5);
  await expect.poll(unseen).toBe(5);
  expect(canvas.hidden).toBe(false);
  stop();
  expect(store.getState().mapFigures).toBeNull();
});

it('counts one picture at a time, then the newest, and shows none that has been replaced', async () => {
  const { store, canvas, asked, stop, unseen } = setUp();
  store.setState({ restedFrames: 2 });
  store.setState({ viewMode: 'pixel-cost' });
  expect(asked.length).toBe(1);
  asked[0].give(4);
  await expect.poll(() => asked.length).toBe(2);
  expect(asked[1].mode).toBe('pixel-cost');
  expect(unseen()).toBeNull();
  expect(canvas.hidden).toBe(true);
  asked[1].give(6);
  await expect.poll(unseen).toBe(6);

  store.setState({ viewMode: 'colours' });
  expect(canvas.hidden).toBe(true);
  stop();
});

it('counts a picture again that moved while it was counted, and came back to rest as it was', async () => {
  const { store, canvas, asked, stop, unseen } = setUp();
  store.setState({ isIdle: false });
  asked[0].give(4);
  await expect.poll(() => canvas.hidden).toBe(true);
  await Promise.resolve();
  expect(unseen()).toBeNull();
  store.setState({ isIdle: true });
  await expect.poll(() => asked.length).toBe(2);
  asked[1].give(5);
  await expect.poll(unseen).toBe(5);
  expect(canvas.hidden).toBe(false);
  stop();
});

it('says why there is no map, unless the device has gone', async () => {
  const log = vi.spyOn(console, 'error').mockImplementation(() => {});
  const { store, asked, stop } = setUp();
  asked[0].refuse(new Error('Too many.'));
  await expect
    .poll(() => store.getState().mapFigures)
    .toEqual({ mode: 'tile-cost', restedFrames: 1, kind: 'failure', message: 'Too many.' });
  expect(log).toHaveBeenCalledOnce();
  store.setState({ restedFrames: 2, mapFigures: null, status: 'lost' });
  asked[1].refuse(new Error('Lost.'));
  await expect.poll(() => asked.length).toBe(2);
  expect(store.getState().mapFigures).toBeNull();
  log.mockRestore();
  stop();
});
