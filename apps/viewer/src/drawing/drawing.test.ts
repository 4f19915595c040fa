import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import type { ViewCamera } from '../camera/view-camera.ts';
import type { Scenes } from '../scene/scenes.ts';
import type { Session } from '../session/session.ts';
import { createViewerStore } from '../state/store.ts';
import { Drawing } from './drawing.ts';

beforeEach(() => {
  vi.stubGlobal('requestAnimationFrame', (callback: FrameRequestCallback) => setTimeout(() => callback(0)));
  vi.stubGlobal('cancelAnimationFrame', clearTimeout);
});
afterEach(() => void vi.unstubAllGlobals());

it('has recovered when a whole scene is at rest on the screen, not with a part of it', async () => {
  const main = { render: () => true, effects: () => [] };
  const whenComplete = vi.fn(async () => {});
  const counters = { framesDrawn: 0 };
  const engine = { counters: () => counters, device: { queue: { onSubmittedWorkDone: async () => {} } } };
  const session = {
    canvas: { dataset: {} },
    engine,
    views: { main, whenComplete },
  } as unknown as Session;
  const scene = { id: 1, session, clouds: [] };
  const scenes = {
    drawable: scene,
    newest: null as typeof scene | null,
    isPartial: true,
    takeReplaced: () => [],
  };
  const camera = { update: () => false, orbitCamera: { viewMatrix: [], projectionMatrix: [] } };
  const confirmRecovery = vi.fn();
  const store = createViewerStore();
  store.setState({ widthPx: 30, heightPx: 20 });
  const drawing = new Drawing({
    store,
    sessions: { current: session, confirmRecovery },
    scenes: scenes as unknown as Scenes,
    camera: camera as unknown as ViewCamera,
  });
  drawing.request();
  await expect.poll(() => whenComplete).toHaveBeenCalled();
  await new Promise((resolve) => setImmediate(resolve));
  expect(confirmRecovery).not.toHaveBeenCalled();
  Object.assign(scenes, { newest: scene, isPartial: false });
  drawing.request();
  await expect.poll(() => confirmRecovery).toHaveBeenCalledOnce();
  expect(session.canvas.dataset.resting).toBe('');
});
