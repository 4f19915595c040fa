import { Html } from '@react-three/drei';
import { type SplatCloudObject, Splats } from '@websplatter/react';
import { type ReactNode, useRef } from 'react';
import type { Vector3Tuple } from 'three';

/** Objects beside the still life. */
export interface StillLife {
  /** Places of labels, in world space. */
  readonly labels: readonly Vector3Tuple[];
  /** Whether there is a mesh right before the camera. */
  readonly hasMesh?: boolean;
}

/** Splats, labels that they may hide, and a mesh in front that may take their clicks. */
export function StillLifeScene({
  labels,
  hasMesh = false,
  onSplats,
  onClick,
}: StillLife & {
  readonly onSplats: (splats: SplatCloudObject | null) => void;
  readonly onClick: (what: string) => void;
}): ReactNode {
  const splats = useRef<SplatCloudObject>(null!);
  return (
    <>
      <Splats
        ref={(object) => {
          onSplats(object);
          if (object) splats.current = object;
        }}
        src="still-life-small.spz"
        onClick={() => onClick('splats')}
      />
      {hasMesh && (
        // biome-ignore lint/a11y/noStaticElementInteractions: a mesh is no element of the page.
        <mesh
          name="pane"
          position={[0.12, 0.45, 1.3]}
          onClick={(event) => {
            event.stopPropagation();
            onClick('mesh');
          }}
        >
          <planeGeometry />
          <meshBasicMaterial transparent opacity={0.1} />
        </mesh>
      )}
      {labels.map((place, i) => (
        <Html key={place.join()} position={place} occlude={[splats]} eps={-1}>
          <span id={`label-${i}`}>·</span>
        </Html>
      ))}
    </>
  );
}
