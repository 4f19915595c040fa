import { Float, Html, OrbitControls } from '@react-three/drei';
import { SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { type RefObject, Suspense, useRef } from 'react';

const LABELS = [
  { text: 'Before the vase', position: [0.1, 0.1, 0.45] },
  { text: 'Behind the vase', position: [-0.28, 0.1, -0.5] },
  { text: 'Above the table', position: [0, 0.6, 0] },
] as const;

export default function Labels() {
  const splats = useRef<SplatCloudObject>(null);
  return (
    <SplatCanvas flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
      <Suspense>
        <Splats ref={splats} src="still-life.sog" />
        {LABELS.map(({ text, position }) => (
          <Float key={text} speed={1} rotationIntensity={0} floatIntensity={0.1}>
            {/* With `eps`, drei looks in every frame, not only after the label has moved. */}
            <Html position={position} occlude={[splats as RefObject<SplatCloudObject>]} eps={-1} center>
              <span className="label">{text}</span>
            </Html>
          </Float>
        ))}
      </Suspense>
      <OrbitControls makeDefault />
    </SplatCanvas>
  );
}
