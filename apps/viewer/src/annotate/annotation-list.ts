import type { Annotation } from '../state/annotating.ts';
import { SCENE_LINK_FIELDS } from '../state/scene-link-fields.ts';
import { MAX_ANNOTATIONS } from './annotations.ts';

const { encode: encodeAnnotation, decode: decodeAnnotation } = SCENE_LINK_FIELDS.annotation;

/** Storage key of a scene's annotations. */
export function annotationListKey(contentKey: string): string {
  return `websplatter:annotations:${contentKey}`;
}

/** The list as text for the browser's storage. */
export function writeAnnotationList(list: readonly Annotation[]): string {
  return JSON.stringify(list.map(encodeAnnotation));
}

/** Reads the stored text; skips invalid parts, which must not prevent the viewer from starting. */
export function readAnnotationList(text: string | null): readonly Annotation[] {
  try {
    const list: unknown = JSON.parse(text ?? '[]');
    return Array.isArray(list) ? list.flatMap(readAnnotation).slice(0, MAX_ANNOTATIONS) : [];
  } catch {
    // What is stored is no list: the scene has no annotations, as on a first visit.
    return [];
  }
}

function readAnnotation(text: unknown): readonly Annotation[] {
  try {
    return typeof text === 'string' ? [decodeAnnotation(text)] : [];
  } catch {
    // One annotation that cannot be read must not hide the others.
    return [];
  }
}

/** Linked annotations, then stored ones at other positions. */
export function joinedAnnotations(
  first: readonly Annotation[],
  kept: readonly Annotation[],
): readonly Annotation[] {
  const placeOf = (annotation: Annotation) => encodeAnnotation(annotation).split(',', 1)[0];
  const places = new Set(first.map(placeOf));
  return [...first, ...kept.filter((each) => !places.has(placeOf(each)))].slice(0, MAX_ANNOTATIONS);
}
