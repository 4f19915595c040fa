import { flippedPoint } from '../camera/flip.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { pickSplat } from '../inspect/pick-splat.ts';
import type { Annotation } from '../state/annotating.ts';
import type { ViewerStore } from '../state/store.ts';

/** More are not placed: an address has them all. */
export const MAX_ANNOTATIONS = 50;
/** So many steps can be undone. */
const MOST_STEPS = 50;

/**
 * Places an annotation on the splat that is seen at `xPart`, `yPart` from the image's top left, and
 * opens it; it shows the view on the screen. Says so where there is no splat.
 */
export async function placeAnnotation(panel: PanelProps, xPart: number, yPart: number): Promise<void> {
  const { store, viewer } = panel;
  const pick = await pickSplat(panel, xPart, yPart);
  const { annotating, isFlipped } = store.getState();
  const { list, isPlacing } = annotating;
  if (!isPlacing) return;
  if (!pick) {
    store.setState({ notice: 'No splat is drawn there.' });
    return;
  }
  if (list.length >= MAX_ANNOTATIONS) {
    store.setState({ notice: `A scene has no more than ${MAX_ANNOTATIONS} annotations. Remove one first.` });
    return;
  }
  const point = isFlipped ? flippedPoint(pick.point) : pick.point;
  const placed: Annotation = { point, title: '', text: '', view: viewer.camera.keptView };
  take(store, [...list, placed], list.length);
}

/** Shows the annotation and its view, or with null none. */
export function openAnnotation({ store, viewer }: PanelProps, openIndex: number | null): void {
  const { annotating } = store.getState();
  store.setState({ annotating: { ...annotating, openIndex, isPlacing: false } });
  if (openIndex !== null) viewer.camera.goTo(annotating.list[openIndex].view);
}

export function editAnnotation(
  store: ViewerStore,
  index: number,
  words: Pick<Annotation, 'title' | 'text'>,
): void {
  const { list, openIndex } = store.getState().annotating;
  const { title, text } = list[index];
  if (words.title === title && words.text === text) return;
  const edited = list.map((each, i) => (i === index ? { ...each, ...words } : each));
  take(store, edited, openIndex);
}

export function removeAnnotation(store: ViewerStore, index: number): void {
  const { list } = store.getState().annotating;
  take(
    store,
    list.filter((_, i) => i !== index),
    null,
  );
  store.setState({ notice: 'The annotation is removed. Ctrl+Z, or Undo in the View panel, brings it back.' });
}

export function undoAnnotating(store: ViewerStore): void {
  const { list, past, undone } = store.getState().annotating;
  const before = past.at(-1);
  if (before) goBack(store, before, past.slice(0, -1), [...undone, list]);
}

export function redoAnnotating(store: ViewerStore): void {
  const { list, past, undone } = store.getState().annotating;
  const next = undone.at(-1);
  if (next) goBack(store, next, [...past, list], undone.slice(0, -1));
}

type Lists = readonly (readonly Annotation[])[];

function goBack(store: ViewerStore, list: readonly Annotation[], past: Lists, undone: Lists): void {
  store.setState({ annotating: { list, openIndex: null, isPlacing: false, past, undone } });
}

function take(store: ViewerStore, list: readonly Annotation[], openIndex: number | null): void {
  store.setState(({ annotating }) => {
    const past = [...annotating.past, annotating.list].slice(-MOST_STEPS);
    return { annotating: { list, openIndex, isPlacing: false, past, undone: [] } };
  });
}
