import { beforeEach, describe, expect, it, vi } from 'vitest';
import { createViewerStore, type ViewerStore } from '../../state/store.ts';
import type { AskedHandle } from '../open/file-drop.ts';
import { FileMemory, type FileStore, type KeptFile } from './file-memory.ts';

let store: ViewerStore;
let kept: KeptFile | null;
let memory: FileMemory;

beforeEach(() => {
  store = createViewerStore();
  kept = null;
  const fileStore: FileStore = {
    read: async () => kept,
    readRecent: async () => (kept ? [kept] : []),
    write: async (file) => {
      kept = file;
    },
    clear: async () => {
      kept = null;
    },
  };
  memory = new FileMemory(store, async () => fileStore);
});

function fileHandle(name: string, permission: PermissionState = 'granted') {
  return {
    kind: 'file',
    name,
    getFile: vi.fn(async () => new File(['x'], name)),
    requestPermission: vi.fn(async () => permission),
  } satisfies AskedHandle;
}

async function* listed(handles: readonly AskedHandle[]): AsyncIterable<AskedHandle> {
  yield* handles;
}

describe('the memory of files', () => {
  it('offers nothing where no file was opened, or nothing can be kept', async () => {
    await memory.offer();
    expect(store.getState().lastFile).toBeNull();
    const denied = async () => {
      throw new DOMException('no storage', 'SecurityError');
    };
    const without = new FileMemory(store, async () => ({
      read: denied,
      readRecent: denied,
      write: denied,
      clear: denied,
    }));
    await without.offer();
    expect(await without.recent()).toEqual([]);
    without.remember({ names: ['a.ply'], handles: [] }, false);
    without.forget();
    expect(store.getState().lastFile).toBeNull();
  });

  it('offers the file that was opened last, and reads it when that is allowed', async () => {
    const handle = fileHandle('a.ply');
    memory.remember({ names: ['a.ply'], handles: [handle] }, false);
    await memory.offer();
    expect(store.getState().lastFile).toEqual({ name: 'a.ply', isReachable: true });
    const decision = await memory.reopen();
    expect(handle.requestPermission).toHaveBeenCalledWith({ mode: 'read' });
    expect(decision?.opened).toMatchObject([{ name: 'a.ply', source: expect.any(File) }]);
    expect(decision?.handles).toEqual([handle]);
  });

  it('offers together what was added one after another', async () => {
    const handles = ['a.ply', 'b.ply'].map((name) => fileHandle(name));
    for (const handle of handles) memory.remember({ names: [handle.name], handles: [handle] }, true);
    await memory.offer();
    expect(store.getState().lastFile?.name).toBe('a.ply and b.ply');
    expect((await memory.reopen())?.opened.map(({ name }) => name)).toEqual(['a.ply', 'b.ply']);
  });

  it('finds the files of a folder', async () => {
    const files = [fileHandle('meta.json'), fileHandle('means_l.webp')];
    const folder: AskedHandle = { kind: 'directory', name: 'scene', values: () => listed(files) };
    memory.remember({ names: ['scene'], handles: [folder] }, false);
    await memory.offer();
    const opened = (await memory.reopen())?.opened[0];
    expect(opened?.name).toBe('scene');
    expect(opened?.source).toMatchObject({ paths: ['scene/meta.json', 'scene/means_l.webp'] });
  });

  it('has a file without a handle chosen again', async () => {
    memory.remember({ names: ['a.ply'], handles: [] }, false);
    await memory.offer();
    expect(store.getState().lastFile).toEqual({ name: 'a.ply', isReachable: false });
  });

  it('goes on offering a file that it was not allowed to read', async () => {
    memory.remember({ names: ['a.ply'], handles: [fileHandle('a.ply', 'denied')] }, false);
    await memory.offer();
    expect(await memory.reopen()).toBeNull();
    expect(store.getState().notice).toContain('permission');
    expect(store.getState().lastFile).not.toBeNull();
  });

  /**
   * @fault Arguments: the file that the viewer offers again is gone
   * @consequence the reason is shown
   */
  it('says so where the file is gone', async () => {
    const handle = fileHandle('a.ply');
    handle.getFile.mockRejectedValue(new DOMException('It could not be found.', 'NotFoundError'));
    memory.remember({ names: ['a.ply'], handles: [handle] }, false);
    await memory.offer();
    expect(await memory.reopen()).toBeNull();
    expect(store.getState().failure).toMatchObject({
      title: 'a.ply cannot be opened again',
      message: 'It could not be found.',
    });
    expect(store.getState().lastFile).toBeNull();
  });

  it('forgets on demand', async () => {
    memory.remember({ names: ['a.ply'], handles: [] }, false);
    await memory.offer();
    memory.forget();
    expect(store.getState().lastFile).toBeNull();
    await memory.offer();
    expect(store.getState().lastFile).toBeNull();
  });
});

it('lists recent files that have handles, and reads any of them', async () => {
  memory.remember({ names: ['a.ply'], handles: [] }, false);
  expect(await memory.recent()).toEqual([]);
  memory.remember({ names: ['b.ply'], handles: [fileHandle('b.ply')] }, false);
  const [file] = await memory.recent();
  expect(file.name).toBe('b.ply');
  expect((await memory.reopen(file))?.opened).toMatchObject([{ name: 'b.ply' }]);
});
