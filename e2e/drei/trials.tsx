// Components of drei that applications use most, beside splats under three's WebGPURenderer.
import {
  Bounds,
  CameraControls,
  Environment,
  Html,
  OrbitControls,
  TransformControls,
} from '@react-three/drei';
import type { RootState } from '@react-three/fiber';
import type { SplatCloudObject } from '@websplatter/react';
import type { ComponentProps, ComponentType, ReactNode } from 'react';

/** Stands on the right of a Canvas of 240 × 160 pixels, whose left shows a red ball of splats. */
export interface Trial {
  readonly element: ComponentType<SceneProps>;
  /**
   * The expected effect: pixels change; the camera, or the object named `target`, moves when the
   * mouse is dragged across the middle of the right half; or what `holds` says becomes so.
   */
  readonly expects: 'pixels' | 'camera' | 'target' | 'holds';
  readonly holds?: (state: RootState) => boolean;
  /** Whether it covers the splats, or moves them: they are not looked for then. */
  readonly coversSplats?: boolean;
}

export interface SceneProps {
  readonly splats: React.RefObject<SplatCloudObject | null>;
}

const RIGHT = [1.5, 0, 0] as const;
/** On the ray through the red ball's middle, twice and half as far from the camera. */
const BEHIND = [-3, 0, -5] as const;
const BEFORE = [-0.75, 0, 2.5] as const;

function Box(props: ComponentProps<'mesh'>): ReactNode {
  return (
    <mesh position={RIGHT} {...props}>
      <boxGeometry />
      <meshStandardMaterial color="#40c060" />
    </mesh>
  );
}

const isShown = (id: string) => document.getElementById(id)?.checkVisibility() === true;

/** By name. */
export const TRIALS: Readonly<Record<string, Trial>> = {
  OrbitControls: { element: () => <OrbitControls />, expects: 'camera', coversSplats: true },
  CameraControls: { element: () => <CameraControls />, expects: 'camera', coversSplats: true },
  TransformControls: {
    element: () => (
      <TransformControls mode="translate" size={2} position={RIGHT}>
        <Box name="target" position={[0, 0, 0]} />
      </TransformControls>
    ),
    expects: 'target',
  },
  Bounds: {
    element: () => (
      <Bounds fit observe margin={1}>
        <Box />
      </Bounds>
    ),
    expects: 'holds',
    holds: ({ camera }) => camera.position.z < 4,
    coversSplats: true,
  },
  'Html occlude': {
    element: ({ splats }) => (
      <>
        {/* Without `eps`, drei looks again only when the camera moves. */}
        <Html position={BEHIND} occlude={[splats as React.RefObject<SplatCloudObject>]} eps={-1}>
          <b id="behind">Label</b>
        </Html>
        <Html position={BEFORE} occlude={[splats as React.RefObject<SplatCloudObject>]} eps={-1}>
          <b id="before">Label</b>
        </Html>
      </>
    ),
    expects: 'holds',
    holds: () => isShown('before') && !isShown('behind'),
  },
  Environment: { element: () => <Environment files="sky.hdr" background />, expects: 'pixels' },
};
