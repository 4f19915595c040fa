import { Suspense } from 'react';
import { useStore } from 'zustand';
import { DropZone } from '../file-drop/drop-zone.tsx';
import type { FileDropDecision } from '../file-drop/file-drop.ts';
import { ThinProgress } from '../messages/load-panel.tsx';
import { MessagePanel } from '../messages/message-panel.tsx';
import { hasAnnotationCard } from '../state/annotating.ts';
import { lazyComponent } from '../ui/lazy.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { LostGpu } from './lost-gpu.tsx';
import { Picture, smallParts } from './picture.tsx';

const AnnotationCard = lazyComponent(async () => (await smallParts()).AnnotationCard);

/** The picture alone (`?noui`). Failures are told: silence would look like a long load. */
export function PlainPicture({
  store,
  viewer,
  poster,
  onDrop,
}: PanelProps & { poster: string | null; onDrop: (decision: FileDropDecision) => void }) {
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
          </div>
        </div>
        <ThinProgress store={store} />
        <DropZone onDrop={onDrop} />
      </main>
      <LostGpu store={store} viewer={viewer} />
    </>
  );
}
