import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

export default function XRay() {
  const [isOnTop, setOnTop] = useState(true);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.2, 0.5, 1.5], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="terrain.ply" position-y={-0.15} />
          {/* Clouds of a higher order are drawn over all splats of lower ones. */}
          <Splats src="knot.ply" position-y={-0.05} scale={0.4} renderOrder={isOnTop ? 1 : 0} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          <input type="checkbox" checked={isOnTop} onChange={() => setOnTop(!isOnTop)} /> See through the
          mountain
        </label>
      </form>
    </>
  );
}
