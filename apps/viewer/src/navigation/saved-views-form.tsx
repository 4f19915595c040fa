import { useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import type { SavedView } from '../state/saved-view.ts';
import { IconButton, TextButton } from '../ui/controls.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { SavedViews } from './saved-views.ts';
import { drawThumbnail, showThumbnail } from './thumbnail.ts';

/** The views that a person has saved of this scene. */
export function SavedViewsForm({ store, viewer }: PanelProps) {
  const list = useStore(store, (state) => state.savedViews);
  const isPlaying = useStore(store, (state) => state.isPathPlaying);
  const hasScene = useStore(store, (state) => state.scene !== null);
  const views = useMemo(
    () =>
      new SavedViews({
        store,
        camera: viewer.camera,
        draw: () => drawThumbnail(viewer, store.getState().accuracy),
        storage: () => localStorage,
      }),
    [store, viewer],
  );
  useEffect(() => views.watch(), [views]);
  return (
    <fieldset className="view-field">
      <legend>Saved views</legend>
      {list.length > 0 && (
        <ol className="saved-views" data-testid="saved-views">
          {list.map((view, i) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: views have no name but their place.
            <li key={i}>
              <button
                type="button"
                className="saved-view"
                aria-label={`View ${i + 1}`}
                data-testid={`saved-view-${i + 1}`}
                onClick={() => views.show(view)}
              >
                <Thumbnail view={view} />
              </button>
              <IconButton
                icon="close"
                className="icon-button saved-view-remove"
                label={`Remove view ${i + 1}`}
                onClick={() => views.remove(view)}
              />
            </li>
          ))}
        </ol>
      )}
      <div className="view-actions">
        <TextButton disabled={!hasScene} testId="save-view" onClick={() => void views.save()}>
          Save this view
        </TextButton>
        {list.length > 1 && (
          <TextButton testId="play-path" onClick={() => (isPlaying ? views.pause() : views.play())}>
            {isPlaying ? 'Pause' : 'Play as a path'}
          </TextButton>
        )}
      </div>
      <p>
        Kept in this browser by the name of the scene.
        {list.length > 1 && ' Save and share (X) makes a video of the path.'}
      </p>
    </fieldset>
  );
}

function Thumbnail({ view }: { view: SavedView }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current) void showThumbnail(canvas.current, view.thumbnail);
  }, [view]);
  return <canvas ref={canvas} />;
}
