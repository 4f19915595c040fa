import { expect, it, vi } from 'vitest';
import type { Sphere } from '../camera/scene-bounds.ts';
import type { Viewer } from '../engine/viewer.ts';
import { type EffectOwner, NO_EFFECTS } from '../state/effects.ts';
import { createViewerStore } from '../state/store.ts';
import { awaitsViewMode } from '../state/view-mode.ts';
import { followViewMode } from './follow-view-mode.ts';

function setUp() {
  const store = createViewerStore();
  const camera = {
    subjectSphere: { center: [0, 0, 0], radius: 1 } as Sphere | null,
    controls: { pose: { distance: 4 } },
  };
  const setEffects = vi.fn((owner: EffectOwner, uses) =>
    store.setState(({ requested }) => ({ requested: { ...requested, [owner]: uses } })),
  );
  const viewer = { camera, setEffects } as unknown as Viewer;
  const namesOf = () => store.getState().requested['view-mode'].map(({ effect }) => effect.name);
  return { store, camera, viewer, setEffects, namesOf };
}

it('draws with the effects of the mode once they are there, in each scene anew, until colours are chosen', async () => {
  const { store, camera, viewer, setEffects, namesOf } = setUp();
  followViewMode(store, viewer);
  expect(awaitsViewMode(store.getState())).toBe(false);
  store.setState({ viewMode: 'depth' });
  expect(awaitsViewMode(store.getState())).toBe(true);
  await expect.poll(namesOf).toEqual(['depth-colors']);
  expect(awaitsViewMode(store.getState())).toBe(false);

  const [before] = store.getState().requested['view-mode'];
  store.setState({ requested: NO_EFFECTS });
  expect(store.getState().requested['view-mode']).toEqual([before]);
  camera.subjectSphere = { center: [0, 0, 0], radius: 2 };
  store.setState({ isFlipped: true });
  const [after] = store.getState().requested['view-mode'];
  expect(after.options).toMatchObject({ bounds: { radius: 2 } });
  expect((after.options as { focusDistance: () => number }).focusDistance()).toBe(4);

  setEffects.mockClear();
  store.setState({ notice: 'something else' });
  expect(setEffects).not.toHaveBeenCalled();
  store.setState({ viewMode: 'colours' });
  expect(namesOf()).toEqual([]);
  setEffects.mockClear();
  store.setState({ requested: NO_EFFECTS });
  expect(setEffects).not.toHaveBeenCalled();
});

it('waits for a scene', async () => {
  const { store, camera, viewer, namesOf } = setUp();
  camera.subjectSphere = null;
  store.setState({ viewMode: 'centres' });
  followViewMode(store, viewer);
  await vi.dynamicImportSettled();
  expect(namesOf()).toEqual([]);
  camera.subjectSphere = { center: [0, 0, 0], radius: 1 };
  store.setState({ isFlipped: true });
  expect(namesOf()).toEqual(['centres', 'antialias']);
});

it('shows colours, and says why, where its code cannot be fetched; the next choice fetches it again', async () => {
  const log = vi.spyOn(console, 'error').mockImplementation(() => {});
  const { store, viewer, namesOf } = setUp();
  const fetchCode = vi.fn(() => import('./apply-view-mode.ts')).mockRejectedValueOnce(new Error('offline'));
  followViewMode(store, viewer, fetchCode);
  store.setState({ viewMode: 'overdraw' });
  await expect.poll(() => store.getState().notice).toContain('could not be fetched');
  expect(store.getState().viewMode).toBe('colours');
  expect(log).toHaveBeenCalledOnce();
  log.mockRestore();
  store.setState({ viewMode: 'overdraw' });
  await expect.poll(namesOf).toEqual(['overdraw', 'antialias']);
});
