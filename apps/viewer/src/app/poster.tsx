import { useState } from 'react';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';

/** An image in place of the scene, until that is on the screen as a whole. */
export function Poster({ store, address }: { store: ViewerStore; address: string }) {
  const isSceneShown = useStore(store, ({ imageId }) => imageId > 0);
  const [isMissing, setIsMissing] = useState(false);
  if (isSceneShown || isMissing) return null;
  // The canvas has the words for both.
  return (
    <img
      className="over-picture poster"
      src={address}
      alt=""
      data-testid="poster"
      onError={() => setIsMissing(true)}
    />
  );
}
