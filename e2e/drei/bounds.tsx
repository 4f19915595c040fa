import {
  ArcballControls,
  CameraControls,
  FlyControls,
  MapControls,
  OrbitControls,
  OrthographicCamera,
  TrackballControls,
} from '@react-three/drei';
import type { RootState } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { SplatBounds, type SplatBoundsApi } from '@websplatter/react/components';
import { type ComponentType, type ReactNode, Suspense } from 'react';

type Controls = ComponentType<{ makeDefault: true }>;

/** Controls by name; null: no controls. */
const CONTROLS: Readonly<Record<string, Controls | null>> = {
  none: null,
  ArcballControls: ArcballControls as Controls,
  // With a focal offset, which fitting must reset.
  CameraControls: ({ makeDefault }) => (
    <CameraControls
      makeDefault={makeDefault}
      ref={(controls) => void controls?.setFocalOffset(0.5, 0, 0, false)}
    />
  ),
  FlyControls: FlyControls as Controls,
  MapControls: MapControls as Controls,
  OrbitControls: OrbitControls as Controls,
  TrackballControls: TrackballControls as Controls,
};

/** Options of a Canvas with `<SplatBounds>`. */
export interface FittedScene {
  readonly controls: string;
  readonly isOrthographic: boolean;
}

/** Two clouds on both sides of a point that is not the default target of controls. */
export function FittedCanvas({
  controls,
  isOrthographic,
  onCreated,
  onFit,
  children,
}: FittedScene & {
  readonly onCreated: (state: RootState) => void;
  readonly onFit: (bounds: SplatBoundsApi) => void;
  readonly children: ReactNode;
}): ReactNode {
  const Controls = CONTROLS[controls];
  return (
    <SplatCanvas flat dpr={1} camera={{ position: [0, 0, 9], fov: 50 }} onCreated={onCreated}>
      {isOrthographic && <OrthographicCamera makeDefault position={[0, 0, 9]} />}
      <SplatBounds margin={1.5} onChange={onFit}>
        <Suspense>
          <Splats src="ball.ply" position={[2, 1, -1]} />
          <Splats src="ball.ply" position={[4, 2, -2]} />
        </Suspense>
      </SplatBounds>
      {Controls && <Controls makeDefault />}
      {children}
    </SplatCanvas>
  );
}
