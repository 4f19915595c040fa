import { Loader, OrbitControls } from '@react-three/drei';
import { Canvas } from '@react-three/fiber';
import { createSplatRenderer, Splats } from '@websplatter/react';
import { Suspense } from 'react';

export default function WithSuspense() {
  return (
    <>
      <Canvas gl={createSplatRenderer} flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense fallback={<Placeholder />}>
          <Splats src="still-life.ply" />
        </Suspense>
        <OrbitControls />
      </Canvas>
      {/* Hears of the load from three's LoadingManager, as of any texture's or model's. */}
      <Loader containerStyles={{ background: 'transparent', alignItems: 'end', paddingBottom: 40 }} />
    </>
  );
}

function Placeholder() {
  return (
    <mesh rotation-x={-Math.PI / 2}>
      <circleGeometry args={[0.6, 48]} />
      <meshBasicMaterial color="#888888" wireframe />
    </mesh>
  );
}
