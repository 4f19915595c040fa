import type { RootState } from '@react-three/fiber';
import { SplatCanvas, Splats, SplatsErrorBoundary } from '@websplatter/react';
import { type ReactNode, StrictMode, Suspense } from 'react';

/** As the file `a.ply` of the test is seen by it. */
const CAMERA = { position: [1.5, 1, 5], fov: 50, near: 0.1, far: 100 } as const;

/** A page that a server renders: the same tree there and in the browser. */
export function PosterPage({ onCreated }: { onCreated?: (state: RootState) => void }): ReactNode {
  return (
    <StrictMode>
      <SplatsErrorBoundary>
        <SplatCanvas
          poster="poster.gif"
          posterAlt="Splats from afar"
          flat
          // Canvas asks for another kind of shadow map by default, which three warns to have removed.
          shadows="percentage"
          frameloop="demand"
          camera={CAMERA}
          style={{ height: '100vh', boxSizing: 'border-box', padding: '0 16px 8px' }}
          onCreated={onCreated}
        >
          <color attach="background" args={['black']} />
          <Suspense>
            <Splats src="a.ply" />
          </Suspense>
        </SplatCanvas>
      </SplatsErrorBoundary>
    </StrictMode>
  );
}
