import { Suspense } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { hasAnnotating } from '../state/annotating.ts';
import { isMapMode } from '../state/view-mode.ts';
import { lazyComponent } from '../ui/lazy.tsx';
import { FreeArea } from './free-area.tsx';
import { Poster } from './poster.tsx';
import { Viewport } from './viewport.tsx';

/** Fetched once for all of them. */
export const smallParts = () => import('./small-parts.ts');
const AnnotationMarkers = lazyComponent(async () => (await smallParts()).AnnotationMarkers);
const SplitImage = lazyComponent(async () => (await smallParts()).SplitImage);
const ModeMap = lazyComponent(async () => (await smallParts()).ModeMap);
const ErrorMapImage = lazyComponent(async () => (await smallParts()).ErrorMapImage);
const LookedPicture = lazyComponent(async () => (await smallParts()).LookedPicture);

/**
 * The picture, and the image that is compared with it.
 *
 * @param poster address of an image to show until there is a picture.
 */
export function Picture({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const comparison = useStore(store, (state) => state.comparison);
  const isLooked = useStore(store, (state) => state.looked !== null && state.judged !== null);
  const isAnnotated = useStore(store, hasAnnotating);
  const hasMap = useStore(store, (state) => isMapMode(state.viewMode));
  return (
    <>
      <Viewport store={store} viewer={viewer} />
      <FreeArea viewer={viewer} />
      {poster && <Poster store={store} address={poster} />}
      {/* Below the right side of a split image: the map is that of the left one. */}
      <Suspense>{hasMap && <ModeMap store={store} viewer={viewer} />}</Suspense>
      <Suspense>
        {comparison?.kind === 'split' && <SplitImage store={store} viewer={viewer} split={comparison} />}
        {comparison?.kind === 'error' && <ErrorMapImage store={store} viewer={viewer} />}
        {isLooked && <LookedPicture store={store} />}
      </Suspense>
      <Suspense>{isAnnotated && <AnnotationMarkers store={store} viewer={viewer} />}</Suspense>
    </>
  );
}
