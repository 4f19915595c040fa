import { advance, createPortal, createRoot, type RootState, useFrame, useThree } from '@react-three/fiber';
import type { SplatEngine } from '@websplatter/core';
import { act, createElement, Fragment } from 'react';
import { Scene } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { useFramePace } from './use-frame-pace.ts';

/** Work of the GPU that is not finished yet, by what finishes it. */
let unfinished: (() => void)[];
let roots: ReturnType<typeof createRoot>[];
/** Callbacks for the next frame of the display. */
let requested: Map<number, FrameRequestCallback>;

const queue = { onSubmittedWorkDone: () => new Promise<void>((resolve) => unfinished.push(resolve)) };
const engine = { device: { queue } } as unknown as SplatEngine;

beforeEach(() => {
  vi.useFakeTimers({ toFake: ['performance'] });
  [unfinished, roots, requested] = [[], [], new Map()];
  let requests = 0;
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);
  vi.stubGlobal('requestAnimationFrame', (callback: FrameRequestCallback) => {
    requested.set(++requests, callback);
    return requests;
  });
  vi.stubGlobal('cancelAnimationFrame', (id: number) => requested.delete(id));
});
afterEach(async () => {
  for (const root of roots) await act(async () => root.unmount());
  // Ends the loop, which all Canvases of a page share.
  await display(2);
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

/** A Canvas with two users of the pace, one of them in a portal. */
async function canvas(frameloop: 'always' | 'demand' | 'never', given: SplatEngine | null = engine) {
  const render = vi.fn();
  const frame = vi.fn();
  const element = { addEventListener() {}, removeEventListener() {} } as unknown as HTMLCanvasElement;
  const root = createRoot(element);
  roots.push(root);
  const gl = { render, setPixelRatio() {}, setSize() {}, dispose() {} };
  const size = { width: 96, height: 64, top: 0, left: 0 };
  await root.configure({ gl: gl as never, frameloop, size, dpr: 1 });
  let state!: RootState;
  const Paced = () => {
    useFramePace(given);
    return null;
  };
  const Content = () => {
    state = useThree();
    useFrame(() => frame());
    return null;
  };
  const content = createElement(
    Fragment,
    null,
    createElement(Content),
    createElement(Paced),
    createPortal(createElement(Paced), new Scene()),
  );
  await act(async () => void root.render(content));
  return { root, render, frame, invalidate: () => state.invalidate() };
}

/** Lets the display show frames. */
async function display(times: number): Promise<void> {
  for (let i = 0; i < times; i++) {
    const callbacks = [...requested.values()];
    requested.clear();
    vi.advanceTimersByTime(16);
    for (const callback of callbacks) callback(i);
    await Promise.resolve();
  }
}

async function finish(count = unfinished.length): Promise<void> {
  for (const resolve of unfinished.splice(0, count)) resolve();
  for (let turn = 0; turn < 5; turn++) await Promise.resolve();
}

/** @fault three.js and React: an animation loop of three.js or react-three-fiber is faster than the GPU */
it('leaves frames out while three wait for the GPU, and goes on by itself', async () => {
  const { render, frame } = await canvas('always');
  await display(20);
  expect([render, frame].map(({ mock }) => mock.calls.length)).toEqual([3, 3]);
  for (let drawn = 4; drawn < 8; drawn++) {
    await finish(1);
    await display(5);
    expect([render, frame].map(({ mock }) => mock.calls.length)).toEqual([drawn, drawn]);
  }
});

it('draws the last frame that was requested, and none that was not', async () => {
  const { render, invalidate } = await canvas('demand');
  for (let i = 0; i < 10; i++) {
    invalidate();
    await display(1);
  }
  expect(render).toHaveBeenCalledTimes(3);
  await finish();
  await display(5);
  expect(render).toHaveBeenCalledTimes(4);
  await finish();
  await display(5);
  expect(render).toHaveBeenCalledTimes(4);
});

it('leaves other Canvases, and frames that the application draws itself, alone', async () => {
  const paced = await canvas('always');
  const other = await canvas('always', null);
  await display(20);
  expect(paced.render).toHaveBeenCalledTimes(3);
  expect(other.render).toHaveBeenCalledTimes(20);
  advance(0, true);
  expect(paced.render).toHaveBeenCalledTimes(4);

  // Its errors end turns of the loop halfway.
  other.frame.mockImplementation(() => {
    throw new Error('of the application');
  });
  for (let i = 0; i < 3; i++) await expect(display(1)).rejects.toThrow('of the application');
  other.frame.mockImplementation(() => {});
  await finish();
  await display(2);
  expect(paced.render.mock.calls.length).toBeGreaterThan(4);
});

it('ends with the Canvas, and counts nothing after that', async () => {
  const { root, render } = await canvas('always');
  await display(20);
  await act(async () => root.unmount());
  await finish();
  await display(5);
  expect(render).toHaveBeenCalledTimes(3);
  advance(0, true);
  expect(unfinished).toEqual([]);
});
