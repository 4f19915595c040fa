import { Suspense } from 'react';
import { useStore } from 'zustand';
import { isMapMode } from '../state/view-mode.ts';
import { lazyComponent } from '../ui/lazy.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { FreeArea } from './free-area.tsx';
import { Poster } from './poster.tsx';
import { Viewport } from './viewport.tsx';

const SplitImage = lazyComponent(async () => (await import('../comparison/split-image.tsx')).SplitImage);
const ModeMap = lazyComponent(async () => (await import('../view-modes/mode-map.tsx')).ModeMap);
const ErrorMapImage = lazyComponent(
  async () => (await import('../comparison/error-map-image.tsx')).ErrorMapImage,
);

/**
 * The picture, and the image that is compared with it.
 *
 * @param poster address of an image to show until there is a picture.
 */
export function Picture({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const comparison = useStore(store, (state) => state.comparison);
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
      </Suspense>
    </>
  );
}
