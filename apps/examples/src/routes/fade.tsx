import { Html, OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

/** Heights of the stripes of a wall. */
const STRIPES = Array.from({ length: 9 }, (_, i) => 0.24 * (i - 4));

export default function Fade() {
  const [share, setShare] = useState(0.35);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0, 2.1], fov: 50, near: 0.05 }}>
        {/* Stripes behind both show how much of each is left. */}
        {STRIPES.map((y) => (
          <mesh key={y} position={[0, y, -0.8]}>
            <planeGeometry args={[6, 0.12]} />
            <meshBasicMaterial color="#20324f" />
          </mesh>
        ))}
        <Suspense>
          <Splats src="knot.ply" position-x={-0.65} opacity={share} />
          <Splats src="knot.ply" position-x={0.65} fade={share} />
        </Suspense>
        <Caption x={-0.65}>opacity of each splat</Caption>
        <Caption x={0.65}>fade of the cloud</Caption>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Opacity, fade
          <input
            type="range"
            min={0}
            max={1}
            step="any"
            value={share}
            onChange={(event) => setShare(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}

function Caption({ x, children }: { x: number; children: string }) {
  return (
    <Html position={[x, 0.72, 0]} center>
      <span className="label">{children}</span>
    </Html>
  );
}
