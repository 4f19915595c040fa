import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { MOTION_SLOT, MOTION_VALUES } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { makeSplatData } from '@websplatter/react/own-data';
import { type RefObject, useRef, useState } from 'react';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const DROPS = 14_000;
const GOLDEN_RATIO = (1 + Math.sqrt(5)) / 2;
const GRAVITY = 7;
const LOOP_S = 5;

/** A fountain: drops that rise and fall. Training makes such a set of a film, and a PLY holds it. */
function fountain() {
  const positions = new Float32Array(3 * DROPS);
  const colors = new Float32Array(3 * DROPS);
  const motion = new Float32Array(MOTION_VALUES * DROPS);
  for (let i = 0; i < DROPS; i++) {
    const angle = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const outSpeed = 0.12 + 0.95 * ((i * 0.377) % 1) ** 2;
    // A drop is as opaque as can be at the top of its way, with the velocity that it has there.
    const riseS = 0.68 - 0.28 * outSpeed + 0.06 * ((i * 0.731) % 1);
    const topY = 0.5 * GRAVITY * riseS ** 2 - 0.85;
    const out = outSpeed * riseS;
    positions.set([out * Math.cos(angle), topY, out * Math.sin(angle)], 3 * i);
    const foam = 1 - 0.75 * outSpeed;
    colors.set([0.08 + 0.6 * foam, 0.32 + 0.5 * foam, 0.72 + 0.24 * foam], 3 * i);
    const at = MOTION_VALUES * i;
    // Some drops are at the top before the first time, and after the last.
    motion[at + MOTION_SLOT.time] = 1.4 * (i / DROPS) - 0.2;
    motion[at + MOTION_SLOT.logDuration] = Math.log(0.13);
    // Times from 0 to 1 last LOOP_S.
    motion[at + MOTION_SLOT.velocity] = LOOP_S * outSpeed * Math.cos(angle);
    motion[at + MOTION_SLOT.velocity + 2] = LOOP_S * outSpeed * Math.sin(angle);
    motion[at + MOTION_SLOT.acceleration + 1] = (-GRAVITY / 2) * LOOP_S ** 2;
  }
  const scales = new Float32Array(3 * DROPS).fill(0.013);
  return { ...splatsFromArrays({ positions, colors, scales }), motion };
}

export default function MovingScene() {
  const [data] = useState(() => makeSplatData(fountain()));
  const cloud = useRef<SplatCloudObject>(null);
  const slider = useRef<HTMLInputElement>(null);
  const [time, setTime] = useState(0.5);
  const [isPlaying, setPlaying] = useState(!prefersStillness);
  return (
    <>
      <SplatCanvas
        flat
        frameloop={isPlaying ? 'always' : 'demand'}
        camera={{ position: [0, 0.7, 2.4], fov: 50, near: 0.05 }}
      >
        <Splats src={data} ref={cloud} time={time} />
        {isPlaying && <Playing cloud={cloud} slider={slider} />}
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Time
          <input
            ref={slider}
            type="range"
            min={0}
            max={1}
            step="any"
            defaultValue={time}
            onInput={(event) => {
              setPlaying(false);
              setTime(event.currentTarget.valueAsNumber);
            }}
          />
        </label>
        <label>
          <input
            type="checkbox"
            checked={isPlaying}
            onChange={() => {
              // The moment of the animation stays when it is paused.
              if (slider.current) setTime(slider.current.valueAsNumber);
              setPlaying(!isPlaying);
            }}
          />
          Playing
        </label>
      </form>
    </>
  );
}

/** Sets the time in each frame, without rendering React. */
function Playing({
  cloud,
  slider,
}: {
  cloud: RefObject<SplatCloudObject | null>;
  slider: RefObject<HTMLInputElement | null>;
}) {
  useFrame((_, elapsedS) => {
    if (!cloud.current || !slider.current) return;
    const time = (slider.current.valueAsNumber + elapsedS / LOOP_S) % 1;
    cloud.current.time = time;
    slider.current.value = `${time}`;
  });
  return null;
}
