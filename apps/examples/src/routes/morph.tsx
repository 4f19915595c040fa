import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { type MorphData, makeMorphData } from '@websplatter/react/own-data';
import { type RefObject, useRef, useState } from 'react';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const COUNT = 16_000;
const GOLDEN_RATIO = (1 + Math.sqrt(5)) / 2;
const MAP_WIDTH = 2.4;
const MAP_HEIGHT = 1.5;

/** Points spread evenly over a unit sphere: the sine of each latitude, and the longitude. */
const PLACES = Array.from({ length: COUNT }, (_, i) => {
  const longitude = 2 * Math.PI * ((i / GOLDEN_RATIO) % 1) - Math.PI;
  return { sine: 1 - (2 * i + 1) / COUNT, longitude };
});

function onGlobe({ sine, longitude }: (typeof PLACES)[number]) {
  const radius = Math.sqrt(1 - sine * sine);
  return [radius * Math.sin(longitude), sine, radius * Math.cos(longitude)];
}

/** Colours of sea, coast, land and snow. */
function groundAt(place: (typeof PLACES)[number]) {
  const [x, y, z] = onGlobe(place);
  const height =
    Math.sin(2.3 * x + 1.7) * Math.cos(2.1 * z - 0.6) +
    0.5 * Math.sin(3.9 * y + 2.8 * x - 1.1) +
    0.25 * Math.cos(7.3 * z + 5.1 * y) +
    0.12 * Math.sin(15 * x - 11 * z + 9 * y);
  if (Math.abs(y) > 0.9 + 0.03 * height) return [0.96, 0.97, 1];
  if (height < -0.1) return [0.1, 0.32, 0.6];
  if (height < 0.1) return [0.2, 0.55, 0.72];
  if (height < 0.18) return [0.9, 0.82, 0.58];
  return height < 0.8 ? [0.32, 0.56, 0.26] : [0.58, 0.48, 0.36];
}

/** A globe, lit by the sun from one side. */
function globe() {
  const points = PLACES.map(onGlobe);
  const light = points.map(([x, y, z]) => 0.35 + 0.75 * Math.max(0, 0.55 * z - 0.6 * x + 0.5 * y));
  return {
    positions: points.flatMap((point) => point.map((value) => 0.72 * value)),
    colors: PLACES.flatMap((place, i) => groundAt(place).map((value) => light[i] * value)),
    scales: new Float32Array(3 * COUNT).fill(0.0095),
  };
}

function map() {
  return {
    positions: PLACES.flatMap(({ sine, longitude }) => [
      (MAP_WIDTH / 2) * (longitude / Math.PI),
      (MAP_HEIGHT / 2) * sine,
      0,
    ]),
    colors: PLACES.flatMap(groundAt),
    scales: new Float32Array(3 * COUNT).fill(0.0085),
  };
}

export default function Morph() {
  const [data] = useState(() => makeMorphData(globe(), map()));
  const slider = useRef<HTMLInputElement>(null);
  const [isMoving, setMoving] = useState(!prefersStillness);
  return (
    <>
      <SplatCanvas
        flat
        frameloop={isMoving ? 'always' : 'demand'}
        camera={{ position: [0.5, 0.6, 2], fov: 50, near: 0.05 }}
      >
        <Splats src={data} />
        {isMoving && <Unrolling data={data} slider={slider} />}
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Unrolled
          <input
            ref={slider}
            type="range"
            min={0}
            max={1}
            step="any"
            defaultValue={0}
            onInput={(event) => {
              setMoving(false);
              data.amount = event.currentTarget.valueAsNumber;
            }}
          />
        </label>
        <label>
          <input type="checkbox" checked={isMoving} onChange={() => setMoving(!isMoving)} /> Moving
        </label>
      </form>
    </>
  );
}

/** Morphs between the globe and the map. */
function Unrolling({ data, slider }: { data: MorphData; slider: RefObject<HTMLInputElement | null> }) {
  const phase = useRef(Math.acos(1 - 2 * data.amount));
  useFrame((_state, elapsedS) => {
    phase.current += Math.min(elapsedS, 0.1);
    data.amount = 0.5 - 0.5 * Math.cos(phase.current);
    slider.current!.value = String(data.amount);
  });
  return null;
}
