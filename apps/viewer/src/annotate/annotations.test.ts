import { beforeEach, expect, it, vi } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { redoEdit, undoEdit } from '../state/make-edit.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import {
  editAnnotation,
  MAX_ANNOTATIONS,
  openAnnotation,
  placeAnnotation,
  removeAnnotation,
} from './annotations.ts';

const VIEW = { pose: FRONT, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false };

let store: ViewerStore;
let panel: PanelProps;
const pickAt = vi.fn();
const goTo = vi.fn();
const titles = () => store.getState().annotating.list.map(({ title }) => title);
const begin = () => store.setState(({ annotating }) => ({ annotating: { ...annotating, isPlacing: true } }));

/** Places one with this title. */
async function place(title: string): Promise<void> {
  begin();
  await placeAnnotation(panel, 0.5, 0.5);
  const { openIndex } = store.getState().annotating;
  editAnnotation(store, openIndex!, { title, text: '' });
}

beforeEach(() => {
  vi.clearAllMocks();
  store = createViewerStore();
  const viewer = { shownFrame: null, pickAt, camera: { keptView: VIEW, goTo } };
  panel = { store, viewer: viewer as unknown as PanelProps['viewer'] };
  pickAt.mockResolvedValue({ point: [1, 2, 3] });
});

it('an annotation is placed on the splat of a click, in the space of the scene, and opened', async () => {
  store.setState({ isFlipped: true });
  begin();
  await placeAnnotation(panel, 0.25, 0.75);
  expect(pickAt).toHaveBeenCalledWith(0.25, 0.75);
  const { list, openIndex, isPlacing } = store.getState().annotating;
  expect(list).toEqual([{ point: [1, -2, -3], title: '', text: '', view: VIEW }]);
  expect([openIndex, isPlacing]).toEqual([0, false]);
});

it('none is placed beside splats, after placing was given up, or beyond what links hold', async () => {
  await placeAnnotation(panel, 0.5, 0.5);
  pickAt.mockResolvedValueOnce(null);
  begin();
  await placeAnnotation(panel, 0.5, 0.5);
  expect(store.getState().notice).toBe('No splat is drawn there.');
  expect(store.getState().annotating).toMatchObject({ list: [], isPlacing: true });
  for (let i = 0; i <= MAX_ANNOTATIONS; i++) {
    begin();
    await placeAnnotation(panel, 0.5, 0.5);
  }
  expect(titles().length).toBe(MAX_ANNOTATIONS);
  expect(store.getState().notice).toContain(`no more than ${MAX_ANNOTATIONS}`);
});

it('an annotation that is opened shows its view', async () => {
  await place('A');
  openAnnotation(panel, null);
  expect(goTo).not.toHaveBeenCalled();
  openAnnotation(panel, 0);
  expect(goTo).toHaveBeenCalledWith(VIEW);
  expect(store.getState().annotating.openIndex).toBe(0);
});

it('placing, editing and removing are undone and redone', async () => {
  await place('A');
  await place('B');
  editAnnotation(store, 1, { title: 'B', text: '' });
  removeAnnotation(store, 0);
  expect(titles()).toEqual(['B']);
  const undone = [];
  for (let i = 0; i < 7; i++) {
    undoEdit(store);
    undone.push(titles().join());
  }
  expect(undone).toEqual(['A,B', 'A,', 'A', '', '', '', '']);
  redoEdit(store);
  redoEdit(store);
  expect(titles()).toEqual(['A']);
  await place('C');
  redoEdit(store);
  expect(titles()).toEqual(['A', 'C']);
});
