import type { AccuracySettings } from '@websplatter/core';
import { useEffect, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import type { Viewer } from '../engine/viewer.ts';

/** Pictures are compared once the dial and the camera have rested for this long. */
const RESTS_AFTER_MS = 500;

/**
 * PSNR of the picture on the screen, dB, against that of all splats at the same accuracy; null
 * while that is not known, where all are drawn, and where they are not all there.
 */
export function useDetailDb({ store, viewer }: PanelProps): number | null {
  const imageId = useStore(store, (state) => state.imageId);
  const isMeasuring = useStore(store, (state) => state.measuring !== null);
  const [found, setFound] = useState<{ readonly imageId: number; readonly psnrDb: number | null } | null>(
    null,
  );
  useEffect(() => {
    // Its frames would slow those that are timed.
    if (isMeasuring) return;
    let isCurrent = true;
    const timer = setTimeout(async () => {
      try {
        const psnrDb = await psnrAgainstFull(viewer, store.getState().accuracy);
        if (isCurrent) setFound({ imageId, psnrDb });
      } catch (error) {
        // A scene or device that has gone meanwhile fails the comparison.
        if (isCurrent) console.error(error);
      }
    }, RESTS_AFTER_MS);
    return () => {
      isCurrent = false;
      clearTimeout(timer);
    };
  }, [store, viewer, imageId, isMeasuring]);
  return found?.imageId === imageId ? found.psnrDb : null;
}

async function psnrAgainstFull(viewer: Viewer, accuracy: AccuracySettings): Promise<number | null> {
  const { engine, frame } = viewer.shownFrame ?? {};
  if (!engine || !frame || frame.detail === 'full' || frame.clouds.some(({ cloud }) => cloud.stream))
    return null;
  const { compareViews } = await import('@websplatter/core/measure');
  const views = [frame.detail, 'full' as const].map((detail) => {
    const view = engine.createView();
    view.render({ ...frame, accuracy, detail, force: true });
    return view;
  });
  try {
    return (await compareViews(views[0], views[1])).psnrDb;
  } finally {
    for (const view of views) view.destroy();
  }
}
