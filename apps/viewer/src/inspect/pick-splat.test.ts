import { CodeUnavailableError, DestroyedError, type SplatPick } from '@websplatter/core';
import { expect, it, vi } from 'vitest';
import { fakeTools } from './inspect-tools.fixture.ts';
import { pickSplat } from './pick-splat.ts';

/** Tools with a frame of 200 × 100 pixels, and the view that is made for a pick. */
function setUp() {
  const { tools, viewer, store } = fakeTools({ row: 1 });
  const view = {
    render: vi.fn(),
    pick: vi.fn(async () => ({ row: 2 }) as SplatPick),
    destroy: vi.fn(),
  };
  const frame = { widthPx: 200, heightPx: 100, detail: store.getState().detail };
  viewer.shownFrame = { engine: { createView: () => view }, frame } as unknown as typeof viewer.shownFrame;
  return { tools, viewer, store, view };
}

it('finds what is drawn, where that is every splat', async () => {
  const { tools, viewer, view } = setUp();
  expect(await pickSplat(tools, 0.5, 0.5)).toEqual({ row: 1 });
  expect(viewer.pickAt).toHaveBeenCalledWith(0.5, 0.5);
  expect(view.render).not.toHaveBeenCalled();
});

it('finds a splat among all, where fewer are drawn, and nothing where the device is gone', async () => {
  const { tools, store, view } = setUp();
  store.setState({ detail: { maxSplats: 10 } });
  expect(await pickSplat(tools, 0.5, 0.5)).toEqual({ row: 2 });
  expect(view.render).toHaveBeenCalledWith(expect.objectContaining({ detail: 'full', widthPx: 200 }));
  expect(view.pick).toHaveBeenCalledWith(100, 50);
  view.pick.mockRejectedValueOnce(new Error('The device is lost.'));
  expect(await pickSplat(tools, 0.5, 0.5)).toBeNull();
  expect(view.destroy).toHaveBeenCalledTimes(2);
});

it('says why where code or memory for the search is lacking', async () => {
  const { tools, store, view } = setUp();
  store.setState({ detail: { maxSplats: 10 } });
  const lost = new CodeUnavailableError('picking', { cause: new Error('offline') });
  view.pick.mockRejectedValueOnce(lost);
  expect(await pickSplat(tools, 0.5, 0.5)).toBeNull();
  expect(store.getState().notice).toBe(lost.message);
});

it('says nothing where the session has ended', async () => {
  const { tools, store, view } = setUp();
  store.setState({ detail: { maxSplats: 10 } });
  view.pick.mockRejectedValueOnce(new DestroyedError('This view', 'it was destroyed'));
  expect(await pickSplat(tools, 0.5, 0.5)).toBeNull();
  expect(store.getState().notice).toBeNull();
});
