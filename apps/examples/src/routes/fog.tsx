import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

const FOG_COLOR = '#c9d3df';

export default function Fog() {
  const [density, setDensity] = useState(0.6);
  const [isInFog, setInFog] = useState(true);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        {/* The scene's own background and fog: nothing here is about splats. */}
        <color attach="background" args={[FOG_COLOR]} />
        <fogExp2 attach="fog" args={[FOG_COLOR]} density={density} />
        {[0.4, -0.6, -1.6].map((z) => (
          <mesh key={z} position={[-0.45, 0.1, z]}>
            <sphereGeometry args={[0.1, 48, 24]} />
            <meshBasicMaterial color="#b3261e" />
          </mesh>
        ))}
        <Suspense>
          <Splats src="still-life.sog" fog={isInFog} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Density
          <input
            type="range"
            min={0}
            max={2}
            step="any"
            value={density}
            onChange={(event) => setDensity(event.target.valueAsNumber)}
          />
        </label>
        <label>
          <input type="checkbox" checked={isInFog} onChange={({ target }) => setInFog(target.checked)} />{' '}
          Splats, too
        </label>
      </form>
    </>
  );
}
