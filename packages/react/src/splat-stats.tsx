import type { FrameStatistics } from '@websplatter/core';
import { onStageTimings } from '@websplatter/three';
import { type ReactNode, useEffect } from 'react';
import type { WebGPURenderer } from 'three/webgpu';
import type { PanelCorner, TimingsPanel } from './timings-panel.ts';
import { useMeasuredRenderer } from './use-renderer.ts';
import { useSplatEngine } from './use-splat-engine.ts';

/** Props of `<SplatStats>`. */
export interface SplatStatsProps {
  /** Required outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null or undefined until then. */
  renderer?: object | null;
  /** Default `top-left`. */
  corner?: PanelCorner;
}

/**
 * Shows the costs of splats in a corner over the canvas: times of each stage, frames per second,
 * splats and GPU memory; a small canvas has room for a few of these. The panel is an HTML overlay, at
 * any place of this component in the tree. It updates at most four times a second, without a render
 * of React or a frame of the canvas.
 *
 * @throws InvalidArgumentError outside of a Canvas without `renderer`;
 *   SplatsUnsupportedRendererError for a renderer that cannot draw splats.
 * @example
 * <SplatCanvas flat>
 *   <Splats src="/garden.ply" />
 *   <SplatStats corner="bottom-right" />
 * </SplatCanvas>
 */
export function SplatStats(props: SplatStatsProps): ReactNode {
  const { renderer, corner = 'top-left' } = props;
  const measured = useMeasuredRenderer('renderer' in props ? [renderer] : [], '<SplatStats>');
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
    // Imported when the panel is mounted: pages that never mount it do not load its code.
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
