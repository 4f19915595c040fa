import type { FrameStatistics } from '@websplatter/core';
import { onStageTimings } from '@websplatter/three';
import { type ReactNode, useEffect } from 'react';
import type { WebGPURenderer } from 'three/webgpu';
import type { PanelCorner, TimingsPanel } from './timings-panel.ts';
import { useMeasuredRenderer } from './use-renderer.ts';
import { useSplatEngine } from './use-splat-engine.ts';

/** Props of `<SplatStats>`. */
export interface SplatStatsProps {
  /** Needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null before that. */
  renderer?: object | null;
  /** Default `top-left`. */
  corner?: PanelCorner;
}

/**
 * Shows the costs of splats in a corner over the canvas: times of each stage, frames per second,
 * splats and GPU memory; over a small canvas a few of these. It is an HTML overlay, wherever in the tree this component is. Updates it
 * at most four times a second, and renders nothing for that, in React or on the canvas.
 *
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for a renderer that cannot draw splats.
 */
export function SplatStats({ renderer, corner = 'top-left' }: SplatStatsProps): ReactNode {
  const measured = useMeasuredRenderer(renderer, '<SplatStats>');
  const engine = useSplatEngine(measured);
  useEffect(() => {
    if (!measured || !engine) return;
    const read = () => ({
      framesDrawn: engine.counters().framesDrawn,
      memoryBytes: engine.memory().totalBytes,
      nowMs: performance.now(),
    });
    let isGone = false;
    let latest: FrameStatistics | null = null;
    let panel: TimingsPanel | null = null;
    const stop = onStageTimings(measured, (statistics) => {
      latest = statistics;
      panel?.show(statistics);
    });
    // Imported when the panel is shown: pages whose users never see it do not load it.
    import('./timings-panel.ts')
      .then(({ createTimingsPanel }) => {
        if (isGone) return;
        const { ownerDocument, parentElement } = (measured as WebGPURenderer).domElement;
        panel = createTimingsPanel(ownerDocument, corner, read);
        parentElement?.append(panel.element);
        if (latest) panel.show(latest);
      })
      .catch(console.error);
    return () => {
      isGone = true;
      stop();
      panel?.remove();
    };
  }, [measured, engine, corner]);
  return null;
}
