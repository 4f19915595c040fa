import { CodeUnavailableError, DestroyedError } from '@websplatter/core';
import { opacity } from '@websplatter/core/effects';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import type { ViewCamera } from '../../camera/view-camera.ts';
import { NO_EFFECTS } from '../../state/effects.ts';
import { createViewerStore } from '../../state/store.ts';
import type { Scenes } from '../open/scenes.ts';
import { Drawing } from './drawing.ts';
import type { Session } from './session.ts';

beforeEach(() => {
  vi.stubGlobal('requestAnimationFrame', (callback: FrameRequestCallback) => setTimeout(() => callback(0)));
  vi.stubGlobal('cancelAnimationFrame', clearTimeout);
});
afterEach(() => void vi.unstubAllGlobals());

const SEEN = { viewMatrix: [], projectionMatrix: [] };

/** Draws a scene of which only a part is there. */
function setUp() {
  const whenDrawn = vi.fn(async () => {});
  const main = { render: vi.fn(() => true), effects: () => [], whenDrawn };
  const whenComplete = vi.fn(async () => {});
  const counters = { framesDrawn: 0 };
  const engine = { counters: () => counters, device: { queue: { onSubmittedWorkDone: async () => {} } } };
  const session = {
    engine,
    views: { main, whenComplete },
  } as unknown as Session;
  const scene = { id: 1, session, parts: [], clouds: [] };
  const scenes = {
    drawable: scene,
    newest: null as typeof scene | null,
    isPartial: true,
    takeReplaced: () => [],
    takeBack: vi.fn(),
  };
  const camera = { update: () => false, orbitCamera: SEEN, centredCamera: SEEN };
  const confirmRecovery = vi.fn();
  const sessions = { current: session as Session | null, confirmRecovery };
  const store = createViewerStore();
  store.setState({ widthPx: 30, heightPx: 20 });
  const drawing = new Drawing({
    store,
    sessions,
    scenes: scenes as unknown as Scenes,
    camera: camera as unknown as ViewCamera,
  });
  return { drawing, store, main, sessions, scene, scenes, camera, counters, whenComplete, confirmRecovery };
}

it('has recovered when a whole scene is at rest on the screen, not with a part of it', async () => {
  const { drawing, scene, scenes, whenComplete, confirmRecovery } = setUp();
  drawing.request();
  await expect.poll(() => whenComplete).toHaveBeenCalled();
  await new Promise((resolve) => setImmediate(resolve));
  expect(confirmRecovery).not.toHaveBeenCalled();
  Object.assign(scenes, { newest: scene, isPartial: false });
  drawing.request();
  await expect.poll(() => confirmRecovery).toHaveBeenCalledOnce();
  expect(drawing.isAtRest).toBe(true);
});

it('tells of no picture at rest after the session has ended, until another has drawn', async () => {
  const { drawing, sessions, scene, scenes } = setUp();
  Object.assign(scenes, { newest: scene, isPartial: false });
  drawing.request();
  await expect.poll(() => drawing.isAtRest && drawing.shown !== null).toBe(true);
  sessions.current = null;
  drawing.stop();
  expect(drawing.shown).toBeNull();
});

it('draws nothing while the code of the view mode is on its way', async () => {
  const { drawing, store, main, whenComplete } = setUp();
  store.setState({ viewMode: 'opacity' });
  drawing.request();
  await expect.poll(() => whenComplete).toHaveBeenCalled();
  expect(main.render).not.toHaveBeenCalled();
  store.setState({ requested: { ...NO_EFFECTS, 'view-mode': [opacity(0.5)] } });
  drawing.request();
  await expect.poll(() => main.render).toHaveBeenCalled();
});

it('shows the older frame until a frame in parts is drawn, and counts the pace of such frames', async () => {
  const { drawing, store, main, scene, scenes, camera, counters, whenComplete } = setUp();
  Object.assign(scenes, { newest: scene, isPartial: false });
  const drawnInParts: (() => void)[] = [];
  main.whenDrawn.mockImplementation(() => new Promise((resolve) => drawnInParts.push(resolve)));
  whenComplete.mockReturnValue(new Promise(() => {}));
  const [first, second] = [{ ...SEEN }, { ...SEEN }];
  const drawFrom = async (seen: typeof SEEN) => {
    camera.orbitCamera = seen;
    drawing.request();
    await expect.poll(() => drawnInParts.length).toBe(1);
  };
  const end = async () => {
    counters.framesDrawn++;
    drawnInParts.pop()!();
    await new Promise((resolve) => setImmediate(resolve));
  };
  await drawFrom(first);
  expect(drawing.shown).toBeNull();
  await end();
  await drawFrom(second);
  expect(drawing.shown?.frame.camera).toBe(first);
  expect(store.getState()).toMatchObject({ shownFrames: 1, frameRate: null });
  await end();
  expect(drawing.shown?.frame.camera).toBe(second);
  expect(store.getState()).toMatchObject({ shownFrames: 2, frameRate: { frameMs: expect.any(Number) } });
});

it('shows a frame that is drawn whole together with overlays that follow it at once', async () => {
  const { drawing, store, main, scene, scenes, counters } = setUp();
  Object.assign(scenes, { newest: scene, isPartial: false });
  let seenWhenDrawn = 0;
  main.render.mockImplementation(() => {
    counters.framesDrawn++;
    queueMicrotask(() => {
      seenWhenDrawn = store.getState().shownFrames;
    });
    return true;
  });
  drawing.request();
  await expect.poll(() => seenWhenDrawn).toBe(1);
  expect(main.whenDrawn).not.toHaveBeenCalled();
});

const LOST = new CodeUnavailableError('shaders', { cause: new Error('offline') });

/**
 * @fault Pages and packages: code of shaders is lost while the picture is at rest
 * @consequence the viewer says so at once, not at the next move
 */
it.each([
  ['the frame', 'whenDrawn'],
  ['the picture at rest', 'whenComplete'],
] as const)('reports an error of %s at once, although nothing moves', async (_, rejects) => {
  const { drawing, main, whenComplete, scenes, counters } = setUp();
  const awaited = { whenDrawn: main.whenDrawn, whenComplete }[rejects];
  awaited.mockRejectedValueOnce(LOST);
  main.render.mockImplementation(() => {
    if (awaited.mock.calls.length > 0) throw LOST;
    if (rejects === 'whenComplete') counters.framesDrawn++;
    return true;
  });
  drawing.request();
  await expect.poll(() => scenes.takeBack).toHaveBeenCalledExactlyOnceWith(LOST);
});

it('asks once for a frame that reports an error, which may come back with each frame', async () => {
  const { drawing, main, scene, scenes, whenComplete } = setUp();
  Object.assign(scenes, { newest: scene, isPartial: false });
  main.whenDrawn.mockRejectedValue(LOST);
  whenComplete.mockRejectedValue(LOST);
  drawing.request();
  await expect.poll(() => main.render.mock.calls.length).toBe(2);
  await expect.poll(() => drawing.isAtRest).toBe(true);
  expect(main.render).toHaveBeenCalledTimes(2);
});

it('asks for no frame because a session or a cloud has ended', async () => {
  const { drawing, main, scene, scenes, whenComplete } = setUp();
  Object.assign(scenes, { newest: scene, isPartial: false });
  const ended = new DestroyedError('This view', 'it was destroyed');
  main.whenDrawn.mockRejectedValue(ended);
  whenComplete.mockRejectedValue(ended);
  drawing.request();
  await expect.poll(() => main.render.mock.calls.length).toBe(1);
  await expect.poll(() => drawing.isAtRest).toBe(true);
  expect(main.render).toHaveBeenCalledOnce();
});
