import { flippedPoint } from '../camera/flip.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import { pickSplat } from '../inspect/pick-splat.ts';
import type { Annotation } from '../state/annotating.ts';
import { History, replacement } from '../state/history.ts';
import type { ViewerStore } from '../state/store.ts';

/** Most annotations of a scene: a URL holds them all. */
export const MAX_ANNOTATIONS = 50;
/** Most edits that can be undone. */
const MOST_EDITS = 50;

/**
 * Places an annotation, with the current view, on the splat at `xPart`, `yPart` from the image's
 * top left, and opens it. A notice reports if there is no splat.
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
  take(store, 'Place an annotation', [...list, placed], list.length);
}

/** Opens an annotation and goes to its view; null closes the open one. */
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
  take(store, 'Edit an annotation', edited, openIndex);
}

export function removeAnnotation(store: ViewerStore, index: number): void {
  const { list } = store.getState().annotating;
  const others = list.filter((_, i) => i !== index);
  take(store, 'Remove an annotation', others, null);
  store.setState({
    notice: 'The annotation is removed. Ctrl+Z, or Undo in View and camera (V), brings it back.',
  });
}

export function undoAnnotating(store: ViewerStore): void {
  historyOf(store).undo();
}

export function redoAnnotating(store: ViewerStore): void {
  historyOf(store).redo();
}

function historyOf(store: ViewerStore): History {
  return new History(() => store.getState().annotating, MOST_EDITS);
}

function take(store: ViewerStore, name: string, next: readonly Annotation[], openIndex: number | null): void {
  let opens = openIndex;
  const now = () => store.getState().annotating.list;
  const edit = replacement(name, next, now, (list, steps) => {
    store.setState({ annotating: { list, openIndex: opens, isPlacing: false, ...steps } });
    // Undo and redo open no annotation.
    opens = null;
  });
  historyOf(store).take(edit);
}
