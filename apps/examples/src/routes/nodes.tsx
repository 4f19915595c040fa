import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import {
  splatColor,
  splatNode,
  splatOpacity,
  splatPosition,
  splatPositionWorld,
  splatScale,
} from '@websplatter/react/tsl';
import { Suspense, useRef, useState } from 'react';
import { color, float, length, sin, smoothstep, uniform, vec3 } from 'three/tsl';
import { type Mesh, Vector3 } from 'three/webgpu';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const amount = uniform(0.7);
const timeS = uniform(0);
const lamp = uniform(new Vector3());

// Splats above the table sway; higher ones sway more.
const height = smoothstep(0.3, 0.7, splatPosition.y);
const sway = sin(splatPosition.x.mul(6).sub(timeS.mul(2)))
  .mul(height)
  .mul(amount)
  .mul(0.2);
const wind = splatNode({
  position: splatPosition.add(vec3(sway, 0, 0)),
  reach: { displacement: 0.2 },
});

// Splats grow, starting in the middle of the scene.
const shown = smoothstep(0, 0.4, amount.mul(1.5).sub(length(splatPositionWorld)));
const reveal = splatNode({
  scale: splatScale.mul(shown),
  opacity: splatOpacity.mul(shown),
  reach: { growth: 1 },
});

// A lamp in the dark: light falls off with the square of the distance.
const distance = length(splatPositionWorld.sub(lamp));
const light = color('#ffd9a0')
  .mul(amount)
  .mul(float(0.3).div(distance.mul(distance).add(0.05)));
const relight = splatNode({ color: splatColor.mul(light.add(0.05)) });

const NODES = { Lamp: relight, Wind: wind, Reveal: reveal } as const;

export default function Nodes() {
  const [name, setName] = useState<keyof typeof NODES>('Lamp');
  const [isMoving, setMoving] = useState(!prefersStillness);
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" effects={[NODES[name]]} />
        </Suspense>
        <Lamp isMoving={isMoving} isVisible={name === 'Lamp'} />
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <select
          aria-label="Effect"
          value={name}
          onChange={(event) => setName(event.target.value as keyof typeof NODES)}
        >
          {Object.keys(NODES).map((each) => (
            <option key={each}>{each}</option>
          ))}
        </select>
        <label>
          Amount
          <input
            type="range"
            min={0}
            max={1}
            step="any"
            defaultValue={amount.value}
            onChange={(event) => {
              amount.value = event.target.valueAsNumber;
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

/** Updates the time and the lamp: uniforms need neither a React render nor new shaders. */
function Lamp({ isMoving, isVisible }: { isMoving: boolean; isVisible: boolean }) {
  const bulb = useRef<Mesh>(null);
  useFrame((_state, elapsedS) => {
    if (isMoving) timeS.value += elapsedS;
    lamp.value.set(0.45 * Math.cos(timeS.value), 0.55, 0.45 * Math.sin(timeS.value));
    bulb.current?.position.copy(lamp.value);
  });
  return (
    <mesh ref={bulb} visible={isVisible}>
      <sphereGeometry args={[0.02]} />
      <meshBasicMaterial color="#ffd9a0" />
    </mesh>
  );
}
