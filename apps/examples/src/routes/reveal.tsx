import { OrbitControls } from '@react-three/drei';
import { type RevealAnimation, SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const REVEALS = {
  'From the middle': { from: [0, 0, 0], durationMs: 2500 },
  'From the camera': { from: 'camera', durationMs: 2500 },
} as const satisfies Record<string, RevealAnimation>;

type Name = keyof typeof REVEALS;

export default function Reveal() {
  const [name, setName] = useState<Name>('From the middle');
  const [times, setTimes] = useState(0);
  const reveal = prefersStillness && times === 0 ? undefined : REVEALS[name];
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          {/* A new key starts again. Splats request the frames that this needs, and no more. */}
          <Splats key={times} src="terrain.ply" reveal={reveal} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <select
          aria-label="Where it begins"
          value={name}
          onChange={(event) => setName(event.target.value as Name)}
        >
          {Object.keys(REVEALS).map((each) => (
            <option key={each}>{each}</option>
          ))}
        </select>
        <button type="button" onClick={() => setTimes(times + 1)}>
          Again
        </button>
      </form>
    </>
  );
}
