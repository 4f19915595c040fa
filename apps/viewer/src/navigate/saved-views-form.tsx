import { IconButton, TextButton } from '@websplatter/kit/controls';
import { Icon } from '@websplatter/kit/icon';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { viewName } from '../state/saved-view.ts';
import { showPath } from './show-path.ts';
import { Thumbnail, useSavedViews } from './thumbnails.tsx';

/** URLs hold the names of all views. */
export const MAX_NAME_LENGTH = 60;

/** The list of the scene's saved views. */
export function SavedViewsForm({ store, viewer }: PanelProps) {
  const list = useStore(store, (state) => state.savedViews);
  const isPathVisible = useStore(store, (state) => state.isPathVisible);
  const hasScene = useStore(store, (state) => state.scene !== null);
  const views = useSavedViews({ store, viewer });
  return (
    <fieldset className="view-field">
      <legend>Saved views</legend>
      {list.length > 0 && (
        <ol className="saved-views" data-testid="saved-views">
          {list.map((view, i) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: names may repeat.
            <li key={i}>
              <button
                type="button"
                className="saved-view"
                aria-label={viewName(view, i)}
                data-testid={`saved-view-${i + 1}`}
                onClick={() => viewer.camera.goTo(view)}
              >
                <Thumbnail jpeg={view.thumbnail} />
              </button>
              <input
                type="text"
                className="saved-view-name"
                value={view.name}
                placeholder={viewName({ name: '' }, i)}
                maxLength={MAX_NAME_LENGTH}
                aria-label={`Name of view ${i + 1}`}
                data-testid={`saved-view-name-${i + 1}`}
                onChange={({ target }) => views.rename(view, target.value, target)}
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
        <TextButton
          aria-pressed={isPathVisible}
          aria-keyshortcuts="Q"
          disabled={!hasScene}
          testId="show-path"
          onClick={() => showPath(store, !isPathVisible)}
        >
          <Icon name="path" />
          Camera path
        </TextButton>
      </div>
      <p>
        Kept in this browser with the scene, and in links. The camera path (Q) moves through them, as a
        turntable without any; Save and share (X) makes a video of it.
      </p>
    </fieldset>
  );
}
