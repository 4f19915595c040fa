import { useEffect, useMemo } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { createCommands, listenToKeys } from './commands.ts';
import { followDrop } from './follow-drop.ts';
import { listenForGamepads } from './gamepad-listener.ts';
import { PlainPicture } from './plain-picture.tsx';
import { UnavailablePage } from './status-pages.tsx';

/** The picture alone, and the reason where there can be none. */
export function ScenePage({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const isUnavailable = useStore(store, (state) => state.status === 'unavailable');
  // Without the interface no key does these.
  const run = useMemo(
    () => createCommands(viewer, store, { chooseFiles: () => {}, walk: () => {} }),
    [viewer, store],
  );
  useEffect(() => listenToKeys(viewer, store, run), [viewer, store, run]);
  useEffect(() => listenForGamepads(viewer, store, run), [viewer, store, run]);
  if (isUnavailable) return <UnavailablePage store={store} onRetry={() => viewer.recover()} />;
  return (
    <PlainPicture
      store={store}
      viewer={viewer}
      poster={poster}
      onDrop={(decision) => followDrop(decision, store, viewer)}
    />
  );
}
