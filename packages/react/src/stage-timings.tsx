import type { FrameStatistics } from '@websplatter/core';
import { onStageTimings } from '@websplatter/three';
import { type ReactNode, useEffect } from 'react';
import type { WebGPURenderer } from 'three/webgpu';
import type { PanelCorner, TimingsPanel } from './timings-panel.ts';
import { useMeasuredRenderer } from './use-renderer.ts';

export interface StageTimingsProps {
  /** Needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null while there is none. */
  renderer?: object | null;
  /** Default `top-left`. */
  corner?: PanelCorner;
}

/**
 * Shows what the splats cost per frame, in a corner over the canvas: an HTML overlay, wherever in the tree this component is.
 * Updates it at most four times a second, and renders nothing for that, in React or on the canvas.
 *
 * @throws InvalidArgumentError outside of a Canvas without `renderer`.
 */
export function StageTimings({ renderer, corner = 'top-left' }: StageTimingsProps): ReactNode {
  const measured = useMeasuredRenderer(renderer, '<StageTimings>');
  useEffect(() => {
    if (!measured) return;
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
        panel = createTimingsPanel(ownerDocument, corner);
        if (latest) panel.show(latest);
        parentElement?.append(panel.element);
      })
      .catch(console.error);
    return () => {
      isGone = true;
      stop();
      panel?.remove();
    };
  }, [measured, corner]);
  return null;
}
