import { type ReactNode, useEffect, useRef } from 'react';
import type { PanelCorner, TimingsPanel } from './timings-panel.ts';
import { useCanvasRenderer } from './use-renderer.ts';
import { useStageTimings } from './use-stage-timings.ts';

export interface StageTimingsProps {
  /** Needed outside of the Canvas: its renderer (`onCreated={({ gl }) => …}`); null while there is none. */
  renderer?: object | null;
  /** Default `top-left`. */
  corner?: PanelCorner;
}

/**
 * Shows what the splats cost per frame, in a corner over the canvas: an HTML overlay, wherever in the tree this component is.
 * Updates it at most four times a second, and renders nothing for that, in React or on the canvas.
 */
export function StageTimings({ renderer, corner = 'top-left' }: StageTimingsProps): ReactNode {
  const canvasRenderer = useCanvasRenderer();
  if (renderer === null) return null;
  // `useStageTimings` throws if there is no renderer.
  return <Overlay renderer={(renderer ?? canvasRenderer) as MeasuredRenderer} corner={corner} />;
}

interface MeasuredRenderer {
  readonly domElement: HTMLCanvasElement;
}

function Overlay({ renderer, corner }: { renderer: MeasuredRenderer; corner: PanelCorner }): ReactNode {
  const panel = useRef<TimingsPanel>(null);
  useEffect(() => {
    let isGone = false;
    // Imported when the panel is shown: pages whose users never see it do not load it.
    import('./timings-panel.ts')
      .then(({ createTimingsPanel }) => {
        if (isGone) return;
        const { ownerDocument, parentElement } = renderer.domElement;
        panel.current = createTimingsPanel(ownerDocument, corner);
        parentElement?.append(panel.current.element);
      })
      .catch((error: unknown) => console.error(error));
    return () => {
      isGone = true;
      panel.current?.remove();
      panel.current = null;
    };
  }, [renderer, corner]);
  useStageTimings((statistics) => panel.current?.show(statistics), renderer);
  return null;
}
