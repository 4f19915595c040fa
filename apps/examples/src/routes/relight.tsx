import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

export default function Relight() {
  const [across, setAcross] = useState(-0.25);
  const [strength, setStrength] = useState(1);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0.75, 2], fov: 40, near: 0.05 }}>
        <color attach="background" args={['#0b0e16']} />
        {/* The scene's own lights: nothing here is about splats. */}
        <ambientLight color="#8fa3d8" intensity={0.35} />
        <directionalLight color="#5f83ff" position={[3, 2, -1]} intensity={2.5} />
        <pointLight color="#ff9a3c" position={[across, 0.12, 0.62]} intensity={0.9} />
        <mesh position={[across, 0.12, 0.62]}>
          <sphereGeometry args={[0.03, 32, 16]} />
          <meshBasicMaterial color="#ffe3b8" />
        </mesh>
        <mesh position-y={-0.16} rotation-x={-Math.PI / 2}>
          <circleGeometry args={[1.4, 64]} />
          <meshLambertMaterial color="#e8e2d6" />
        </mesh>
        <Suspense>
          <Splats src="figures.ply" relight={strength} />
        </Suspense>
        <OrbitControls target={[0, 0, 0.35]} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Lamp
          <input
            type="range"
            min={-0.6}
            max={0.6}
            step="any"
            value={across}
            onChange={(event) => setAcross(event.target.valueAsNumber)}
          />
        </label>
        <label>
          Relight
          <input
            type="range"
            min={0}
            max={1}
            step="any"
            value={strength}
            onChange={(event) => setStrength(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}
