import { type CSSProperties, type ReactNode, useContext, useEffect, useRef, useState } from 'react';
import { FallbackContext, SplatsErrorBoundary } from './splats-error-boundary.tsx';

/** Time in which the poster fades, ms. */
const FADE_MS = 300;

/** Same layout as react-three-fiber's own element, which fills this one. */
const FRAME: CSSProperties = {
  position: 'relative',
  width: '100%',
  height: '100%',
  overflow: 'hidden',
  isolation: 'isolate',
};

/** Over the canvas, inside of any padding of the frame. */
const LAYER: CSSProperties = {
  position: 'absolute',
  inset: 0,
  boxSizing: 'border-box',
  padding: 'inherit',
  pointerEvents: 'none',
};

const IMAGE: CSSProperties = { display: 'block', width: '100%', height: '100%', objectFit: 'cover' };

/** At the lower edge of the poster, legible over any picture. */
const FALLBACK: CSSProperties = {
  position: 'absolute',
  inset: 'auto 0 0',
  zIndex: 1,
  maxHeight: '100%',
  overflow: 'auto',
  padding: '0 1em',
  background: 'Canvas',
  color: 'CanvasText',
};

interface PosterFrameProps {
  poster: ReactNode;
  alt: string;
  className?: string;
  style?: CSSProperties;
  /** Returns the Canvas, which calls `onShown` when it shows its splats. */
  children: (onShown: () => void) => ReactNode;
}

/**
 * Covers a Canvas with a poster until the Canvas shows its splats. If it cannot draw, the poster
 * stays, under the `fallback` of the surrounding `<SplatsErrorBoundary>`.
 */
export function PosterFrame({ poster, alt, className, style, children }: PosterFrameProps): ReactNode {
  const layer = useRef<HTMLDivElement>(null);
  const [isGone, setGone] = useState(false);
  const fallback = useContext(FallbackContext);
  const canvas = children(() => {
    // jsdom has neither `matchMedia` nor `animate`.
    const isStill = globalThis.matchMedia?.('(prefers-reduced-motion: reduce)').matches;
    const fade = isStill
      ? null
      : layer.current?.animate?.({ opacity: 0 }, { duration: FADE_MS, fill: 'forwards' });
    if (fade) fade.onfinish = () => setGone(true);
    else setGone(true);
  });
  return (
    <div className={className} style={{ ...FRAME, ...style }}>
      {fallback === undefined ? (
        canvas
      ) : (
        <SplatsErrorBoundary
          fallback={(error) => (
            <Failure onMount={() => setGone(false)}>
              {typeof fallback === 'function' ? fallback(error) : fallback}
            </Failure>
          )}
        >
          {canvas}
        </SplatsErrorBoundary>
      )}
      {!isGone && (
        <div ref={layer} style={LAYER}>
          {typeof poster === 'string' ? (
            <img src={poster} alt={alt} fetchPriority="high" style={IMAGE} />
          ) : (
            poster
          )}
        </div>
      )}
    </div>
  );
}

function Failure({ children, onMount }: { children: ReactNode; onMount: () => void }): ReactNode {
  // biome-ignore lint/correctness/useExhaustiveDependencies: once.
  useEffect(onMount, []);
  return <div style={FALLBACK}>{children}</div>;
}
