import { OrbitControls } from '@react-three/drei';
import { openFrames, type SplatFrames } from '@websplatter/core/frames';
import { SplatCanvas, Splats } from '@websplatter/react';
import { useSplatSequence } from '@websplatter/react/sequence';
import { Suspense, useEffect, useState } from 'react';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

/** Frames that stand in a row behind the bird. */
const ROW = [1, 4, 7, 10, 13, 16, 19];

/** One file, which holds all frames; its first ones are there before the rest. */
function useFramesFile(address: string): SplatFrames | null {
  const [file, setFile] = useState<SplatFrames | null>(null);
  useEffect(() => {
    const ending = new AbortController();
    let opened: SplatFrames | null = null;
    const open = async () => {
      opened = await openFrames(address, { signal: ending.signal });
      if (ending.signal.aborted) opened.end();
      else setFile(opened);
    };
    open().catch((error) => ending.signal.aborted || console.error(error));
    return () => {
      ending.abort();
      opened?.end();
    };
  }, [address]);
  return file;
}

export default function FramesFile() {
  const [isPlaying, setPlaying] = useState(!prefersStillness);
  const file = useFramesFile('bird.frames');
  const { data, frame, frameCount, isBuffering, seek } = useSplatSequence(file?.frames ?? [], {
    framesPerS: file?.framesPerS ?? 24,
    isPlaying,
  });
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.45, 0.45, 1.3], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src={data} />
          {file &&
            ROW.map((each, place) => (
              <Splats
                key={each}
                src={file.frames[each]}
                position={[0.33 * (place - (ROW.length - 1) / 2), 0.55, -0.8]}
                scale={0.36}
              />
            ))}
        </Suspense>
        <OrbitControls target={[0, 0.08, 0]} />
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
            max={Math.max(0, frameCount - 1)}
            value={frame}
            onChange={(event) => seek({ frame: event.target.valueAsNumber })}
          />
        </label>
        <output>{isBuffering ? 'Loading …' : `${frame + 1} of ${frameCount}`}</output>
      </form>
    </>
  );
}
