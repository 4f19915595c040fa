import type { KeptScene } from '@websplatter/core/keep';
import { IconButton, TextButton } from '@websplatter/kit/controls';
import { formatBytes, formatSplats } from '@websplatter/kit/format';
import { Icon } from '@websplatter/kit/icon';
import { useCallback, useEffect, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import type { ScenePartSummary } from '../state/scene-part.ts';
import type { ViewerStore } from '../state/store.ts';
import { Dock } from '../ui/dock.tsx';
import { withCode } from '../ui/lazy.tsx';
import { lookPart, removePart } from './edit-parts.ts';
import { PartForm } from './part-form.tsx';
import { selectedPartOf } from './selected-part.ts';

/**
 * The files of the scene: visibility, number of splats and placement of each, and the files still
 * loading.
 */
export function CloudsPanel({ store, viewer, onAdd }: PanelProps & { onAdd: () => void }) {
  const parts = useStore(store, (state) => state.scene?.parts);
  return (
    <Dock store={store} name="clouds">
      <div className="dock-body">
        <ul className="parts">
          {parts?.map((part) => (
            <Part key={part.key} store={store} viewer={viewer} part={part} isOnly={parts.length === 1} />
          ))}
        </ul>
        <Coming store={store} viewer={viewer} />
        <TextButton aria-keyshortcuts="J" title="Add files (J)" testId="add-files" onClick={onAdd}>
          <Icon name="add" />
          Add files
        </TextButton>
        <p>The handles in the picture move the chosen file along the scene’s axes.</p>
        <p className="drop-hint">Dropped with Shift, files are added too.</p>
        <KeptScenes store={store} />
      </div>
    </Dock>
  );
}

function Part({
  store,
  viewer,
  part,
  isOnly,
}: PanelProps & { readonly part: ScenePartSummary; readonly isOnly: boolean }) {
  const isSelected = useStore(store, (state) => selectedPartOf(state)?.key === part.key);
  const { key, title, splats, look } = part;
  const verb = look.isHidden ? 'Show' : 'Hide';
  return (
    <li className="part" data-hidden={look.isHidden || undefined} data-testid="part">
      <div className="part-row">
        <IconButton
          icon={look.isHidden ? 'hidden' : 'view'}
          label={`${verb} ${title}`}
          title={verb}
          testId="part-visible"
          onClick={() =>
            lookPart({ store, viewer }, part, look.isHidden ? 'showing' : 'hiding', {
              isHidden: !look.isHidden,
            })
          }
        />
        <button
          type="button"
          className="part-name"
          aria-expanded={isSelected}
          disabled={isOnly}
          data-testid="part-name"
          onClick={() => store.setState({ selectedPart: isSelected ? null : key })}
        >
          <span>{title}</span>
          <small>{formatSplats(splats)}</small>
          {!isOnly && <Icon name="more" />}
        </button>
        {!isOnly && (
          <IconButton
            icon="close"
            label={`Remove ${title}`}
            title="Remove"
            testId="part-remove"
            onClick={() => removePart({ store, viewer }, part)}
          />
        )}
      </div>
      {isSelected && <PartForm store={store} viewer={viewer} part={part} />}
    </li>
  );
}

/** The file being opened, and the queued files. */
function Coming({ store, viewer }: PanelProps) {
  const title = useStore(store, (state) => state.load?.title);
  const waiting = useStore(store, (state) => state.waiting);
  if (title === undefined) return null;
  return (
    <ul className="parts" aria-label="Files to open">
      <li className="part-row">
        <p className="part-name">
          <span>{title}</span>
          <small>Opening</small>
        </p>
        <TextButton look="plain" onClick={() => viewer.scenes.cancelLoad()}>
          Cancel
        </TextButton>
      </li>
      {waiting.map((part) => (
        <li key={part.key} className="part-row" data-testid="waiting">
          <p className="part-name">
            <span>{part.title}</span>
            <small>Waiting</small>
          </p>
          <IconButton
            icon="close"
            label={`Cancel ${part.title}`}
            onClick={() => viewer.scenes.remove(part.key)}
          />
        </li>
      ))}
    </ul>
  );
}

/** Large files that the browser stores for streaming, and the size of each. */
function KeptScenes({ store }: { store: ViewerStore }) {
  const [scenes, setScenes] = useState<readonly KeptScene[]>([]);
  const list = useCallback(async () => {
    const { keptScenes } = await import('@websplatter/core/keep');
    setScenes(await keptScenes());
  }, []);
  useEffect(() => {
    // Some windows have no storage. Code that cannot be fetched is missed by those who keep a file, too.
    const look = () => void list().catch(() => {});
    look();
    return store.subscribe(({ load }) => load?.phase, look);
  }, [store, list]);
  const remove = (scene: KeptScene) =>
    withCode(
      store,
      () => Promise.all([import('@websplatter/core/keep'), import('../engine/open/load-kept.ts')]),
      async ([{ removeKept }, { endUses }]) => {
        endUses();
        if (!(await removeKept(scene)))
          store.setState({
            notice: `${scene.fileName} is open here or in another window. Close it there first.`,
          });
        await list();
      },
    );
  if (scenes.length === 0) return null;
  return (
    <section>
      <h3>Kept by the browser</h3>
      <ul className="parts">
        {scenes.map((scene) => (
          <li key={scene.key} className="part-row" data-testid="kept">
            <p className="part-name">
              <span>{scene.fileName}</span>
              <small>
                {formatBytes(scene.bytes)}
                {!scene.isWhole && ', not finished'}
              </small>
            </p>
            <TextButton look="plain" testId="remove-kept" onClick={() => void remove(scene)}>
              Remove
            </TextButton>
          </li>
        ))}
      </ul>
    </section>
  );
}
