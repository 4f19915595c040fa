import { OrbitControls } from '@react-three/drei';
import { invalidate, useFrame } from '@react-three/fiber';
import { splatsFromText } from '@websplatter/core/make';
import { SplatCanvas, Splats } from '@websplatter/react';
import { makeSplatData } from '@websplatter/react/own-data';
import { splatColor, splatIndex, splatNode, splatPosition, splatScale } from '@websplatter/react/tsl';
import { useRef, useState } from 'react';
import { color, hash, mix, smoothstep, uniform, vec3 } from 'three/tsl';

const DURATION_S = 3;

/** 0: all is dust; 1: the word stands. */
const progress = uniform(0.6);

// Letters settle from left to right. Each splat has a place of its own in the cloud of dust.
const flight = smoothstep(0, 1, splatPosition.x.mul(0.6).add(1.4).sub(progress.mul(2.4)));
const seed = vec3(hash(splatIndex), hash(splatIndex.add(100_003)), hash(splatIndex.add(200_003)));
const away = seed.sub(vec3(0.2, 0.4, 0.5)).mul(vec3(1.3, 1.4, 1));
const dust = splatNode({
  position: splatPosition.add(away.mul(flight)),
  scale: splatScale.mul(mix(1, 0.75, flight)),
  color: mix(splatColor, color('#ff7a2e'), flight),
  reach: { displacement: 1.5 },
});
const effects = [dust];

export default function TextDust() {
  const [text] = useState(() =>
    makeSplatData(splatsFromText('Splats', { font: 'Georgia, serif', weight: 700, color: '#1d3f8f' })),
  );
  const slider = useRef<HTMLInputElement>(null);
  const [isPlaying, setPlaying] = useState(false);
  const show = (value: number) => {
    progress.value = value;
    slider.current!.value = String(value);
    if (value >= 1) setPlaying(false);
    invalidate();
  };
  return (
    <>
      <SplatCanvas
        flat
        frameloop={isPlaying ? 'always' : 'demand'}
        camera={{ position: [0.5, 0.2, 3], fov: 50, near: 0.05 }}
      >
        <Splats src={text} effects={effects} />
        {isPlaying && <Playing show={show} />}
        <OrbitControls target={[0.35, 0.1, 0]} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Settled
          <input
            ref={slider}
            type="range"
            min={0}
            max={1}
            step="any"
            defaultValue={progress.value}
            onInput={(event) => {
              setPlaying(false);
              show(event.currentTarget.valueAsNumber);
            }}
          />
        </label>
        <button
          type="button"
          onClick={() => {
            show(0);
            setPlaying(true);
          }}
        >
          Play
        </button>
      </form>
    </>
  );
}

function Playing({ show }: { show: (value: number) => void }) {
  useFrame((_state, elapsedS) => show(progress.value + Math.min(elapsedS, 0.1) / DURATION_S));
  return null;
}
