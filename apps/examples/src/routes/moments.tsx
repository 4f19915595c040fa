import { OrbitControls } from '@react-three/drei';
import { MOTION_SLOT, MOTION_VALUES } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { SplatCanvas, Splats } from '@websplatter/react';
import { makeSplatData } from '@websplatter/react/own-data';
import { useState } from 'react';

const SPARKS = 3_000;
const GOLDEN_RATIO = (1 + Math.sqrt(5)) / 2;
const MOMENTS = [0, 1, 2, 3, 4];

/** A firework: sparks that fly to all sides, slow down and fall. */
function firework() {
  const colors = new Float32Array(3 * SPARKS);
  const motion = new Float32Array(MOTION_VALUES * SPARKS);
  for (let i = 0; i < SPARKS; i++) {
    const y = 1 - (2 * (i + 0.5)) / SPARKS;
    const angle = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const across = Math.sqrt(1 - y * y);
    // Rays of sparks: the fast ones are red, the slow ones yellow.
    const speed = 0.35 + 0.65 * ((i * 0.377) % 1);
    colors.set([1, 1.15 - speed, 0.55 - 0.3 * speed], 3 * i);
    const at = MOTION_VALUES * i;
    const direction = [across * Math.cos(angle), y, across * Math.sin(angle)];
    for (const [axis, value] of direction.entries()) {
      motion[at + MOTION_SLOT.velocity + axis] = 1.25 * speed * value;
      motion[at + MOTION_SLOT.acceleration + axis] = -0.75 * speed * value - (axis === 1 ? 0.25 : 0);
    }
    // After 0.75 s, 1/e of a spark's opacity is left.
    motion[at + MOTION_SLOT.logDuration] = Math.log(0.75);
  }
  const positions = new Float32Array(3 * SPARKS);
  const scales = new Float32Array(3 * SPARKS).fill(0.008);
  return { ...splatsFromArrays({ positions, colors, scales }), motion };
}

export default function Moments() {
  const [data] = useState(() => makeSplatData(firework()));
  const [gap, setGap] = useState(0.17);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0, 4.2], fov: 45, near: 0.05 }}>
        <color attach="background" args={['#0b1230']} />
        {MOMENTS.map((i) => (
          <Splats key={i} src={data} time={0.02 + i * gap} position-x={0.95 * i - 2.05} />
        ))}
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Time between two
          <input
            type="range"
            min={0}
            max={0.24}
            step="any"
            value={gap}
            onChange={(event) => setGap(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}
