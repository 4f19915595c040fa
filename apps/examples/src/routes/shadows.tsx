import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

export default function Shadows() {
  const [angle, setAngle] = useState(0.7);
  const [isOn, setOn] = useState(true);
  return (
    <>
      <SplatCanvas
        flat
        shadows="percentage"
        frameloop="demand"
        camera={{ position: [0, 0.75, 2], fov: 40, near: 0.05 }}
      >
        <ambientLight intensity={1.2} />
        <directionalLight
          castShadow
          position={[3 * Math.sin(angle), 2, 3 * Math.cos(angle)]}
          intensity={2.2}
          shadow-mapSize={[1024, 1024]}
          shadow-camera-left={-1.2}
          shadow-camera-right={1.2}
          shadow-camera-top={1.2}
          shadow-camera-bottom={-1.2}
          shadow-camera-near={1}
          shadow-camera-far={6}
          shadow-bias={-0.001}
        />
        <mesh receiveShadow position-y={-0.16} rotation-x={-Math.PI / 2}>
          <circleGeometry args={[1.4, 64]} />
          <meshLambertMaterial color="#e8e2d6" />
        </mesh>
        <mesh castShadow receiveShadow position={[0.3, 0.36, 0.48]}>
          <sphereGeometry args={[0.1, 48, 24]} />
          <meshLambertMaterial color="#b3261e" />
        </mesh>
        <Suspense>
          <Splats src="figures.ply" castShadow={isOn} receiveShadow={isOn} />
        </Suspense>
        <OrbitControls target={[0, 0, 0.35]} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Sun
          <input
            type="range"
            min={-1.5}
            max={1.5}
            step="any"
            value={angle}
            onChange={(event) => setAngle(event.target.valueAsNumber)}
          />
        </label>
        <label>
          <input type="checkbox" checked={isOn} onChange={({ target }) => setOn(target.checked)} /> Splats,
          too
        </label>
      </form>
    </>
  );
}
