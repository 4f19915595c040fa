import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { useSplatSequence } from '@websplatter/react/sequence';
import { Suspense, useState } from 'react';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

/** One file per frame. */
const FRAMES = [
  'wave-0.ply',
  'wave-1.ply',
  'wave-2.ply',
  'wave-3.ply',
  'wave-4.ply',
  'wave-5.ply',
  'wave-6.ply',
  'wave-7.ply',
];

export default function Sequence() {
  const [isPlaying, setPlaying] = useState(!prefersStillness);
  const { data, frame, frameCount, isBuffering, seek } = useSplatSequence(FRAMES, {
    framesPerS: 8,
    isPlaying,
    maxHeldFrames: FRAMES.length,
  });
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0.9, 1.5], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src={data} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <button type="button" onClick={() => setPlaying(!isPlaying)}>
          {isPlaying ? 'Pause' : 'Play'}
        </button>
        <label>
          Frame
          <input
            type="range"
            min={0}
            max={frameCount - 1}
            value={frame}
            onChange={(event) => seek({ frame: event.target.valueAsNumber })}
          />
        </label>
        <output>{isBuffering ? 'Loading …' : `${frame + 1} of ${frameCount}`}</output>
      </form>
    </>
  );
}
