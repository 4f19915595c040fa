import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

export default function DepthWrite() {
  const [depthWrite, setDepthWrite] = useState(true);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" depthWrite={depthWrite} />
        </Suspense>
        {/* Transparent, and drawn after opaque objects and splats: only depth can hide it. */}
        <mesh position={[-0.2, 0.16, -0.12]} rotation-x={-1.2} renderOrder={1}>
          <torusGeometry args={[0.17, 0.018, 24, 96]} />
          <meshBasicMaterial color="#2d7dff" transparent opacity={0.75} />
        </mesh>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          <input
            type="checkbox"
            checked={depthWrite}
            onChange={({ target }) => setDepthWrite(target.checked)}
          />{' '}
          Splats hide objects that are drawn after them
        </label>
      </form>
    </>
  );
}
