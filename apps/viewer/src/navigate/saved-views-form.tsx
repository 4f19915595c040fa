import { useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { type SavedView, viewName } from '../state/saved-view.ts';
import { IconButton, TextButton } from '../ui/controls.tsx';
import { SavedViews } from './saved-views.ts';
import { drawThumbnail, showThumbnail } from './thumbnail.ts';

/** Addresses have them all. */
const MAX_NAME_LENGTH = 60;

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
        draw: (view) => drawThumbnail({ store, viewer }, view),
      }),
    [store, viewer],
  );
  useEffect(() => views.watch(), [views]);
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const incomplete = list.find(({ thumbnail }) => thumbnail === null);
  useEffect(() => {
    if (hasPicture && incomplete) void views.complete(incomplete);
  }, [views, hasPicture, incomplete]);
  return (
    <fieldset className="view-field">
      <legend>Saved views</legend>
      {list.length > 0 && (
        <ol className="saved-views" data-testid="saved-views">
          {list.map((view, i) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: names may be those of several.
            <li key={i}>
              <button
                type="button"
                className="saved-view"
                aria-label={viewName(view, i)}
                data-testid={`saved-view-${i + 1}`}
                onClick={() => viewer.camera.goTo(view)}
              >
                <Thumbnail view={view} />
              </button>
              <input
                type="text"
                className="saved-view-name"
                value={view.name}
                placeholder={viewName({ name: '' }, i)}
                maxLength={MAX_NAME_LENGTH}
                aria-label={`Name of view ${i + 1}`}
                data-testid={`saved-view-name-${i + 1}`}
                onChange={({ target }) => views.rename(view, target.value)}
              />
              <IconButton
                icon="close"
                className="icon-button saved-view-remove"
                label={`Remove ${viewName(view, i)}`}
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
          <TextButton testId="play-path" onClick={() => (isPlaying ? viewer.camera.endPath() : views.play())}>
            {isPlaying ? 'Pause' : 'Play as a path'}
          </TextButton>
        )}
      </div>
      <p>
        Kept in this browser by the name of the scene, and in links to it.
        {list.length > 1 && ' Save and share (X) makes a video of the path.'}
      </p>
    </fieldset>
  );
}

function Thumbnail({ view }: { view: SavedView }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current) void showThumbnail(canvas.current, view.thumbnail ?? '');
  }, [view]);
  return <canvas ref={canvas} />;
}
