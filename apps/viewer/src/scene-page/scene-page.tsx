import { useEffect, useMemo } from 'react';
import { useStore } from 'zustand';
import { followDrop } from '../file-drop/follow-drop.ts';
import { UnavailablePage } from '../messages/status-pages.tsx';
import { createCommands, listenToKeys } from '../shell/commands.ts';
import { listenForGamepads } from '../shell/gamepad-listener.ts';
import { PlainPicture } from '../shell/plain-picture.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';

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
