import { invalidate, useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { SplatVolume, type SplatVolumeObject } from '@websplatter/react/components';
import { Suspense, useEffect, useRef, useState } from 'react';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const FIGURES = 7;
const STIFFNESS = 90;
/** Less than critical, which is twice the root of the stiffness: the light swings past its aim. */
const DAMPING = 9;
const LONGEST_STEP_S = 1 / 60;

export default function Spring() {
  const [figure, setFigure] = useState(2);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0.4, 1.9], fov: 40, near: 0.05 }}>
        <Suspense>
          <Splats src="figures.ply" />
        </Suspense>
        <Spotlight aim={figure} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Light on
          <input
            type="range"
            min={0}
            max={FIGURES - 1}
            value={figure}
            onChange={(event) => setFigure(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}

/** Darkens all splats outside of a capsule, which a spring draws to a figure. */
function Spotlight({ aim }: { aim: number }) {
  const volume = useRef<SplatVolumeObject>(null);
  const spring = useRef({ value: aim, speed: 0 });
  // Each render has another aim.
  useEffect(() => invalidate());
  useFrame((_state, elapsedS) => {
    const { current } = spring;
    // Steps of springs must be short: a longer frame takes several.
    for (let restS = Math.min(elapsedS, 0.1); restS > 0; restS -= LONGEST_STEP_S) {
      const stepS = Math.min(restS, LONGEST_STEP_S);
      current.speed += (STIFFNESS * (aim - current.value) - DAMPING * current.speed) * stepS;
      current.value += current.speed * stepS;
    }
    const isAtRest = Math.abs(aim - current.value) + Math.abs(current.speed) < 1e-3;
    if (isAtRest || prefersStillness) spring.current = { value: aim, speed: 0 };
    else invalidate();
    // Figures stand in a bow.
    const angle = (spring.current.value / (FIGURES - 1) - 0.5) * 2.2;
    volume.current?.position.set(0.62 * Math.sin(angle), 0.03, 0.75 - 0.62 * Math.cos(angle));
  });
  return (
    <SplatVolume
      ref={volume}
      {...{ shape: 'capsule', radius: 0.11, height: 0.25, softEdge: 0.06 }}
      {...{ mode: 'tint', tint: [0.2, 0.2, 0.28], invert: true }}
    />
  );
}
