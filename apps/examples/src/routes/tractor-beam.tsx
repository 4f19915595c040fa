import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { SplatVolume } from '@websplatter/react/components';
import { Suspense, useState } from 'react';

export default function TractorBeam() {
  const [x, setX] = useState(0.05);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.1, 0.55, 2.25], fov: 50, near: 0.05 }}>
        <ambientLight intensity={1.5} />
        <directionalLight position={[1, 2, 1]} intensity={2} />
        <Suspense>
          <Splats src="meadow.ply" position-y={-0.2} />
        </Suspense>
        {/* What moves the saucer moves its volumes. */}
        <group position={[x, 0.62, 0.2]}>
          <Saucer />
          <group position-y={-0.65}>
            <SplatVolume shape="capsule" mode="displace" offset={[0, 0.35, 0]} {...BEAM} />
            <SplatVolume shape="capsule" mode="tint" tint={[1.3, 1.3, 0.9]} {...BEAM} />
          </group>
        </group>
        <OrbitControls target={[0, 0.12, 0]} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Saucer
          <input
            type="range"
            min={-0.6}
            max={0.6}
            step="any"
            value={x}
            onChange={(event) => setX(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}

const BEAM = { radius: 0.2, height: 1, softEdge: 0.05 };

function Saucer() {
  return (
    <>
      <mesh scale-y={0.22}>
        <sphereGeometry args={[0.3, 48, 24]} />
        <meshStandardMaterial color="#8d97a5" metalness={0.4} roughness={0.4} />
      </mesh>
      <mesh position-y={0.05}>
        <sphereGeometry args={[0.12, 48, 24]} />
        <meshStandardMaterial color="#56c2d6" />
      </mesh>
      <mesh position-y={-0.55}>
        <coneGeometry args={[0.3, 1.05, 48, 1, true]} />
        <meshBasicMaterial color="#ffe98a" transparent opacity={0.3} depthWrite={false} />
      </mesh>
    </>
  );
}
