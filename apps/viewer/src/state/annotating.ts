import type { KeptView } from './saved-view.ts';
import type { Vec3 } from './vec3.ts';

/** Words about a place of the scene. */
export interface Annotation {
  /** In the scene's own space. */
  readonly point: Vec3;
  /** One line; empty without one. */
  readonly title: string;
  readonly text: string;
  /** The view that opening it shows. */
  readonly view: KeptView;
}

export interface Annotating {
  readonly list: readonly Annotation[];
  /** Index of the one that is read or edited; null for none. */
  readonly openIndex: number | null;
  /** Whether the next click in the picture places one. */
  readonly isPlacing: boolean;
}

/** State that a scene without annotations begins with. */
export const NO_ANNOTATIONS: Annotating = {
  list: [],
  openIndex: null,
  isPlacing: false,
};

/** An annotation's title, or its place in the list. */
export function annotationTitle({ title }: Pick<Annotation, 'title'>, index: number): string {
  return title.trim() || `Annotation ${index + 1}`;
}

/** Whether there is one, or one to be placed. */
export function hasAnnotating({ annotating }: { readonly annotating: Annotating }): boolean {
  return annotating.list.length > 0 || annotating.isPlacing;
}

/** Whether there is one to read, or one to be placed. */
export function hasAnnotationCard({ annotating }: { readonly annotating: Annotating }): boolean {
  return annotating.isPlacing || annotating.openIndex !== null;
}

export interface AnnotatingState {
  readonly annotating: Annotating;
}

export const FIRST_ANNOTATING: AnnotatingState = { annotating: NO_ANNOTATIONS };
