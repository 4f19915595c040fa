import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { editsOf, makeSplatData } from '@websplatter/react/own-data';
import { useEffect, useRef, useState } from 'react';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const COUNT = 5_000;
const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));
const ALL = { first: 0, count: COUNT };

/** Seeds of a sunflower with waves that run outwards: x, y, z and r, g, b of each. */
function flower(timeS: number) {
  const positions = new Float32Array(3 * COUNT);
  const colors = new Float32Array(3 * COUNT);
  for (let i = 0; i < COUNT; i++) {
    const radius = Math.sqrt((i + 0.5) / COUNT);
    const angle = i * GOLDEN_ANGLE;
    const wave = Math.sin(9 * radius - 2 * timeS);
    const height = 0.12 + 0.3 * (1 - radius) ** 2 + 0.07 * radius * wave;
    positions.set([radius * Math.cos(angle), height, radius * Math.sin(angle)], 3 * i);
    const light = 0.85 + 0.15 * wave;
    const hue = [1 - 0.85 * radius ** 2, 0.55 - 0.1 * radius, 0.15 + 0.65 * radius];
    colors.set(
      hue.map((channel) => light * channel),
      3 * i,
    );
  }
  return { positions, colors };
}

/** Scales of flat, round splats. */
const SCALES = Float32Array.from({ length: 3 * COUNT }, (_, i) => (i % 3 === 1 ? 0.002 : 0.009));

export default function OwnData() {
  const [data] = useState(() => makeSplatData({ ...flower(0), scales: SCALES }));
  const [shown, setShown] = useState(1);
  const [isMoving, setMoving] = useState(!prefersStillness);
  useEffect(() => {
    const first = Math.round(shown * COUNT);
    editsOf(data).set({ first: 0, count: first }, { visible: true });
    editsOf(data).set({ first, count: COUNT - first }, { visible: false });
  }, [data, shown]);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 1.3, 1.8], fov: 50, near: 0.05 }}>
        <Splats src={data} />
        {isMoving && <Waves data={data} />}
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Seeds
          <input
            type="range"
            min={0}
            max={1}
            step="any"
            value={shown}
            onChange={(event) => setShown(event.target.valueAsNumber)}
          />
        </label>
        <label>
          <input type="checkbox" checked={isMoving} onChange={() => setMoving(!isMoving)} /> Moving
        </label>
      </form>
    </>
  );
}

/** Updates positions and colours of all splats in every frame. An edit requests the next frame. */
function Waves({ data }: { data: ReturnType<typeof makeSplatData> }) {
  const timeS = useRef(0);
  useEffect(() => editsOf(data).set(ALL, flower(timeS.current)), [data]);
  useFrame((_state, elapsedS) => {
    timeS.current += Math.min(elapsedS, 0.1);
    editsOf(data).set(ALL, flower(timeS.current));
  });
  return null;
}
