import { Suspense } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { isGpuLost } from '../state/session.ts';
import { lazyComponent } from '../ui/lazy.tsx';

const LostPage = lazyComponent(async () => (await import('./status-pages.tsx')).LostPage);

/** Shown over the picture while there is no GPU. */
export function LostGpu({ store, viewer }: PanelProps) {
  const isLost = useStore(store, isGpuLost);
  return (
    <Suspense>
      {isLost && (
        <LostPage
          store={store}
          onRecover={() => viewer.recover()}
          onSmallScene={viewer.scenes.isHeld ? null : () => viewer.scenes.openSmallScene()}
        />
      )}
    </Suspense>
  );
}
