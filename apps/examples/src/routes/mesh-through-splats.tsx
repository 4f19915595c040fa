import { useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { type RefObject, Suspense, useRef, useState } from 'react';
import type { Mesh } from 'three';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

export default function MeshThroughSplats() {
  const slider = useRef<HTMLInputElement>(null);
  const [isMoving, setMoving] = useState(!prefersStillness);
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.1, 0.35, 1.5], fov: 50, near: 0.05 }}>
        <ambientLight intensity={1.2} />
        <directionalLight position={[-2, 3, 2]} intensity={2.5} />
        <Suspense>
          <Splats src="still-life.sog" />
        </Suspense>
        <Ball slider={slider} isMoving={isMoving} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Ball
          <input
            ref={slider}
            type="range"
            min={-0.8}
            max={0.8}
            step="any"
            defaultValue={0.6}
            onInput={() => setMoving(false)}
          />
        </label>
        <label>
          <input type="checkbox" checked={isMoving} onChange={() => setMoving(!isMoving)} /> Moving
        </label>
      </form>
    </>
  );
}

/** An ordinary mesh, without any code for splats. */
function Ball({ slider, isMoving }: { slider: RefObject<HTMLInputElement | null>; isMoving: boolean }) {
  const ball = useRef<Mesh>(null);
  useFrame(({ clock }) => {
    if (isMoving) slider.current!.value = String(0.8 * Math.cos(clock.elapsedTime));
    ball.current!.position.z = Number(slider.current!.value);
  });
  return (
    <mesh ref={ball} position-y={0.18}>
      <sphereGeometry args={[0.13, 64, 32]} />
      <meshStandardMaterial color="#e4572e" roughness={0.35} />
    </mesh>
  );
}
