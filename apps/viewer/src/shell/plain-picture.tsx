import { useStore } from 'zustand';
import { ErrorMapImage } from '../comparison/error-map-image.tsx';
import { SplitImage } from '../comparison/split-image.tsx';
import { DropZone } from '../file-drop/drop-zone.tsx';
import type { FileDropDecision } from '../file-drop/file-drop.ts';
import { FailurePanel } from '../messages/failure-panel.tsx';
import { LostPage } from '../messages/status-pages.tsx';
import { isGpuLost } from '../state/viewer-state.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import { Poster } from './poster.tsx';
import { Viewport } from './viewport.tsx';

/** The picture without an interface, as `?noui` asks for it. What fails is said: silence would look like a long load. */
export function PlainPicture({
  store,
  viewer,
  poster,
  onDrop,
}: PanelProps & { poster: string | null; onDrop: (decision: FileDropDecision) => void }) {
  const comparison = useStore(store, (state) => state.comparison);
  const isLost = useStore(store, isGpuLost);
  return (
    <>
      <main>
        <Viewport store={store} viewer={viewer} />
        {poster && <Poster store={store} address={poster} />}
        {comparison?.kind === 'split' && <SplitImage store={store} viewer={viewer} split={comparison} />}
        {comparison?.kind === 'error' && <ErrorMapImage store={store} viewer={viewer} />}
        <div className="overlay">
          <div className="overlay-side">
            <div className="messages">
              <FailurePanel store={store} />
            </div>
          </div>
        </div>
        <DropZone onDrop={onDrop} />
      </main>
      {isLost && (
        <LostPage
          store={store}
          onRecover={() => viewer.recover()}
          onSmallScene={() => viewer.scenes.openSmallScene()}
        />
      )}
    </>
  );
}
