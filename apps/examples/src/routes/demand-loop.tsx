import { OrbitControls } from '@react-three/drei';
import { invalidate, useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { type RefObject, Suspense, useRef } from 'react';

export default function DemandLoop() {
  const counter = useRef<HTMLOutputElement>(null);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="knot.ply" />
        </Suspense>
        <OrbitControls />
        <FrameCounter counter={counter} />
      </SplatCanvas>
      <form className="panel">
        <span>
          Frames drawn: <output ref={counter}>0</output>
        </span>
        <button type="button" onClick={() => invalidate()}>
          Draw one more
        </button>
      </form>
    </>
  );
}

/** Counts without React state, which would render once per frame. */
function FrameCounter({ counter }: { counter: RefObject<HTMLOutputElement | null> }) {
  const frames = useRef(0);
  useFrame(() => {
    frames.current++;
    counter.current!.value = String(frames.current);
  });
  return null;
}
