import { Suspense } from 'react';
import { useStore } from 'zustand';
import { DropZone } from '../file-drop/drop-zone.tsx';
import type { FileDropDecision } from '../file-drop/file-drop.ts';
import { FailurePanel } from '../messages/failure-panel.tsx';
import { isGpuLost } from '../state/viewer-state.ts';
import { late } from '../ui/late.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { Picture } from './picture.tsx';

const LostPage = late(async () => (await import('../messages/status-pages.tsx')).LostPage);

/** The picture without an interface, as `?noui` asks for it. What fails is said: silence would look like a long load. */
export function PlainPicture({
  store,
  viewer,
  poster,
  onDrop,
}: PanelProps & { poster: string | null; onDrop: (decision: FileDropDecision) => void }) {
  const isLost = useStore(store, isGpuLost);
  return (
    <>
      <main>
        <Picture store={store} viewer={viewer} poster={poster} />
        <div className="overlay">
          <div className="overlay-side">
            <div className="messages">
              <FailurePanel store={store} />
            </div>
          </div>
        </div>
        <DropZone onDrop={onDrop} />
      </main>
      <Suspense>
        {isLost && (
          <LostPage
            store={store}
            onRecover={() => viewer.recover()}
            onSmallScene={() => viewer.scenes.openSmallScene()}
          />
        )}
      </Suspense>
    </>
  );
}
