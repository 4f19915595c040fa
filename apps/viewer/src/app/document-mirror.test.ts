import { describe, expect, it } from 'vitest';
import { createViewerStore, type ViewerState } from '../state/store.ts';
import { documentState, documentTitle, mirrorToDocument } from './document-mirror.ts';

const scene = {
  title: 'Garden',
  contentKey: 'scene:garden',
  parts: [],
  clouds: 1,
  splats: 3,
  declaredShDegree: 0,
  shDegree: 0,
  dropped: {},
  notes: [],
  about: null,
  cameras: [],
  canFlip: true,
  isUpsideDown: false,
  canSave: true,
};
const load = {
  title: 'b.ply',
  phase: 'read',
  loadedBytes: 0,
  totalBytes: undefined,
  splats: 0,
  bytesPerSecond: 0,
} as const;
const failure = { title: 'x', message: 'y' };

function stateWith(changes: Partial<ViewerState>): ViewerState {
  return { ...createViewerStore().getState(), ...changes };
}

describe('document mirror', () => {
  it.each([
    [{}, 'starting'],
    [{ status: 'running', scene }, 'ready'],
    [{ status: 'running', scene, load }, 'loading'],
    [{ status: 'running', scene, failure }, 'error'],
    [{ status: 'running', scene, failure, load }, 'loading'],
    [{ status: 'lost', scene, load }, 'lost'],
    [{ status: 'unavailable' }, 'unavailable'],
  ] as const)('sums %o up as %s', (changes, word) => expect(documentState(stateWith(changes))).toBe(word));

  it('names the scene in the title', () => {
    expect(documentTitle(stateWith({}))).toBe('WebSplatter');
    expect(documentTitle(stateWith({ scene }))).toBe('Garden · WebSplatter');
  });

  it('mirrors state and title to the document until told to stop', () => {
    const target = { title: '', documentElement: { dataset: {} as DOMStringMap } };
    const store = createViewerStore();
    const stop = mirrorToDocument(store, target as unknown as Document);
    expect(target.documentElement.dataset.state).toBe('starting');
    store.setState({ status: 'running', scene });
    expect(target).toMatchObject({
      title: 'Garden · WebSplatter',
      documentElement: { dataset: { state: 'ready' } },
    });
    stop();
    store.setState({ status: 'lost' });
    expect(target.documentElement.dataset.state).toBe('ready');
  });
});
