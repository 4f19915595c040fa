import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { type RefObject, Suspense, useRef, useState } from 'react';
import { windSway } from '../effects/wind-sway.ts';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

export default function WindSway() {
  const splats = useRef<SplatCloudObject>(null);
  const [amplitude, setAmplitude] = useState(0.12);
  const [isMoving, setMoving] = useState(!prefersStillness);
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats ref={splats} src="meadow.ply" />
        </Suspense>
        <Wind splats={splats} amplitude={amplitude} isMoving={isMoving} />
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Wind
          <input
            type="range"
            min={0}
            max={0.2}
            step="any"
            value={amplitude}
            onChange={(event) => setAmplitude(event.target.valueAsNumber)}
          />
        </label>
        <label>
          <input type="checkbox" checked={isMoving} onChange={() => setMoving(!isMoving)} /> Moving
        </label>
      </form>
    </>
  );
}

interface WindProps {
  splats: RefObject<SplatCloudObject | null>;
  amplitude: number;
  isMoving: boolean;
}

/** Updates the effect for each frame without a React render. */
function Wind({ splats, amplitude, isMoving }: WindProps) {
  const timeS = useRef(0);
  useFrame((_state, elapsedS) => {
    if (isMoving) timeS.current += elapsedS;
    const options = { amplitude, timeS: timeS.current, ground: -0.3, tall: 0.8 };
    if (splats.current) splats.current.effects = [windSway(options)];
  });
  return null;
}
