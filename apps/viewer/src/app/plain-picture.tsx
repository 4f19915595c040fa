import { Suspense } from 'react';
import { useStore } from 'zustand';
import type { FileDropDecision } from '../engine/open/file-drop.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { DropZone } from '../scene/drop-zone.tsx';
import { hasAnnotationCard } from '../state/annotating.ts';
import { lazyComponent } from '../ui/lazy.tsx';
import { ThinProgress } from './load-panel.tsx';
import { LostGpu } from './lost-gpu.tsx';
import { MessagePanel } from './message-panel.tsx';
import { Picture, smallParts } from './picture.tsx';

// Not one of the small parts: pages with an interface never show it.
const PlainControls = lazyComponent(async () => (await import('./plain-controls.tsx')).PlainControls);
const AnnotationCard = lazyComponent(async () => (await smallParts()).AnnotationCard);

/**
 * The picture (`?noui`) with controls for readers, and without panels. Errors are shown: otherwise a failure would look like a long load.
 */
export function PlainPicture({
  store,
  viewer,
  poster,
  onDrop,
}: PanelProps & { poster: string | null; onDrop: (decision: FileDropDecision) => void }) {
  // The first picture does not wait for them.
  const hasPicture = useStore(store, ({ imageId }) => imageId > 0);
  const hasCard = useStore(store, hasAnnotationCard);
  return (
    <>
      <main>
        <Picture store={store} viewer={viewer} poster={poster} />
        <div className="overlay">
          <div className="overlay-side">
            <div className="messages">
              <Suspense>{hasCard && <AnnotationCard store={store} viewer={viewer} />}</Suspense>
              <MessagePanel store={store} kind="error" />
            </div>
            <Suspense>{hasPicture && <PlainControls store={store} viewer={viewer} />}</Suspense>
          </div>
        </div>
        <ThinProgress store={store} />
        <DropZone onDrop={onDrop} />
      </main>
      <LostGpu store={store} viewer={viewer} />
    </>
  );
}
