import { expect, it, vi } from 'vitest';
import { FileMemory } from '../engine/keep/file-memory.ts';
import type { Viewer } from '../engine/viewer.ts';
import { NOT_FETCHED } from '../state/messages.ts';
import { createViewerStore } from '../state/store.ts';
import { listenForGamepads } from './gamepad-listener.ts';

function offline(): never {
  throw new Error('offline');
}

vi.mock('../engine/keep/reopen-file.ts', offline);
vi.mock('../navigate/gamepads.ts', offline);

/**
 * @fault Pages and packages: code that a gesture needs cannot be fetched
 * @consequence a notice says so; nothing else changes
 */
it('says that a remembered file cannot be reopened for lack of code', async () => {
  const store = createViewerStore();
  const file = { name: 'a.ply', handles: [] };
  const kept = {
    read: async () => file,
    readRecent: async () => [file],
    write: async () => {},
    clear: async () => {},
  };
  const decision = await new FileMemory(store, async () => kept).reopen(file);
  expect(decision).toEqual({ opened: [], notice: NOT_FETCHED });
});

it('says that a gamepad does nothing for lack of code', async () => {
  const store = createViewerStore();
  vi.stubGlobal('window', new EventTarget());
  listenForGamepads({} as Viewer, store, () => {});
  window.dispatchEvent(new Event('gamepadconnected'));
  await expect.poll(() => store.getState().notice).toBe(NOT_FETCHED);
  vi.unstubAllGlobals();
});
