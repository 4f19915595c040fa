import { useStore } from 'zustand';
import { ErrorMapImage } from '../comparison/error-map-image.tsx';
import { SplitImage } from '../comparison/split-image.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { Poster } from './poster.tsx';
import { Viewport } from './viewport.tsx';

/**
 * The picture, and what is compared with it.
 *
 * @param poster address of an image to show until there is a picture.
 */
export function Picture({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const comparison = useStore(store, (state) => state.comparison);
  return (
    <>
      <Viewport store={store} viewer={viewer} />
      {poster && <Poster store={store} address={poster} />}
      {comparison?.kind === 'split' && <SplitImage store={store} viewer={viewer} split={comparison} />}
      {comparison?.kind === 'error' && <ErrorMapImage store={store} viewer={viewer} />}
    </>
  );
}
