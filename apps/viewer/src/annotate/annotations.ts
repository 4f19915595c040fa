import { flippedPoint } from '../camera/flip.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { pickSplat } from '../inspect/pick-splat.ts';
import type { Annotation } from '../state/annotating.ts';
import { makeEdit, replacement } from '../state/make-edit.ts';
import type { ViewerStore } from '../state/store.ts';

/** Most annotations of a scene: a URL holds them all. */
export const MAX_ANNOTATIONS = 50;

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
  take(store, 'new annotation', [...list, placed], list.length);
}

/** Opens an annotation and goes to its view; null closes the open one. */
export function openAnnotation({ store, viewer }: PanelProps, openIndex: number | null): void {
  const { annotating } = store.getState();
  store.setState({ annotating: { ...annotating, openIndex, isPlacing: false } });
  if (openIndex !== null) viewer.camera.goTo(annotating.list[openIndex].view);
}

/** Opens the annotation of a scene that has one, where none is open, without a movement of the camera. */
export function openOnlyAnnotation(store: ViewerStore): void {
  const { annotating } = store.getState();
  if (annotating.list.length === 1 && annotating.openIndex === null)
    store.setState({ annotating: { ...annotating, openIndex: 0 } });
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
  take(store, 'words of an annotation', edited, openIndex);
}

export function removeAnnotation(store: ViewerStore, index: number): void {
  const { list } = store.getState().annotating;
  const others = list.filter((_, i) => i !== index);
  take(store, 'removal of an annotation', others, null);
  store.setState({
    notice: { text: 'The annotation is removed.', offers: [{ label: 'Undo', command: 'undo' }] },
  });
}

function take(store: ViewerStore, name: string, next: readonly Annotation[], openIndex: number | null): void {
  let opens = openIndex;
  const now = () => store.getState().annotating.list;
  const edit = replacement(name, next, now, (list) => {
    store.setState({ annotating: { list, openIndex: opens, isPlacing: false } });
    // Undo and redo open no annotation.
    opens = null;
  });
  makeEdit(store, edit);
}
