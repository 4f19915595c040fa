import { ScrollControls, useScroll } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { Suspense, useRef } from 'react';

const NEAREST = 0.7;
const FARTHEST = 1.9;

export default function ScrollFocus() {
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0.62, 1.2], fov: 50, near: 0.05 }}>
        <Suspense>
          <ScrollControls pages={4}>
            <Meadow />
          </ScrollControls>
        </Suspense>
      </SplatCanvas>
      <p className="panel">Scroll to move the focus.</p>
    </>
  );
}

function Meadow() {
  const cloud = useRef<SplatCloudObject>(null);
  const scroll = useScroll();
  useFrame(() => {
    const focusDistance = NEAREST + (FARTHEST - NEAREST) * scroll.offset;
    if (cloud.current) cloud.current.depthOfField = { focusDistance, aperture: 0.045 };
  });
  return <Splats ref={cloud} src="meadow.ply" />;
}
