import type { KeptScene } from '@websplatter/core/keep';
import { useCallback, useEffect, useState } from 'react';
import type { ViewerStore } from '../state/store.ts';
import { TextButton } from '../ui/controls.tsx';
import { formatBytes } from '../ui/format.ts';

/** Large files that the browser keeps arranged for streaming, and the storage that each takes. */
export function KeptScenes({ store }: { store: ViewerStore }) {
  const [scenes, setScenes] = useState<readonly KeptScene[]>([]);
  const list = useCallback(async () => {
    const { keptScenes } = await import('@websplatter/core/keep');
    setScenes(await keptScenes());
  }, []);
  useEffect(() => {
    // Some windows have no storage, and keep none.
    const look = () => void list().catch(() => {});
    look();
    return store.subscribe(({ load }, before) => {
      if (load?.phase !== before.load?.phase) look();
    });
  }, [store, list]);
  const remove = async (scene: KeptScene) => {
    const [{ removeKept }, { endUses }] = await Promise.all([
      import('@websplatter/core/keep'),
      import('../engine/load-kept.ts'),
    ]);
    endUses();
    if (!(await removeKept(scene)))
      store.setState({ notice: `${scene.fileName} is in use, here or in another window.` });
    await list();
  };
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
