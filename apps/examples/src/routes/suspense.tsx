import { OrbitControls, useProgress } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useRef } from 'react';

export default function WithSuspense() {
  const bar = useRef<HTMLProgressElement>(null);
  // Progress of three's LoadingManager, to which splats report like textures and models.
  const { active, item } = useProgress();
  const showProgress = ({ loaded, total }: ProgressEvent) => {
    // Without a value the bar is indeterminate: a response compressed by the server has no known
    // total.
    if (bar.current && total > 0) bar.current.value = loaded / total;
  };
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense fallback={<Placeholder />}>
          <Splats src="still-life.sog" onProgress={showProgress} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      {active && (
        <label className="panel">
          Loading {item.split('/').at(-1)}
          <progress ref={bar} />
        </label>
      )}
    </>
  );
}

function Placeholder() {
  return (
    <>
      <mesh rotation-x={-Math.PI / 2}>
        <circleGeometry args={[0.6, 48]} />
        <meshBasicMaterial color="#8a8f99" wireframe />
      </mesh>
      <mesh position={[-0.2, 0.15, -0.12]}>
        <cylinderGeometry args={[0.06, 0.1, 0.3, 16, 4, true]} />
        <meshBasicMaterial color="#2d7dff" wireframe />
      </mesh>
      <mesh position={[0.2, 0.09, -0.04]}>
        <sphereGeometry args={[0.12, 16, 8]} />
        <meshBasicMaterial color="#ff8a00" wireframe />
      </mesh>
    </>
  );
}
