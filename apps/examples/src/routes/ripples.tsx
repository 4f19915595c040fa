import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { splatsFromImage } from '@websplatter/core/make';
import { SplatCanvas, Splats } from '@websplatter/react';
import { makeSplatData } from '@websplatter/react/own-data';
import { splatColor, splatNode, splatPosition } from '@websplatter/react/tsl';
import { useState } from 'react';
import { cos, exp, float, length, uniform, vec3 } from 'three/tsl';
import { Vector2 } from 'three/webgpu';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

/** Tiles of a pool, 200 × 150 pixels; a photograph would come from `createImageBitmap`. */
function paintTiles(): OffscreenCanvas {
  const canvas = new OffscreenCanvas(200, 150);
  const context = canvas.getContext('2d')!;
  context.fillStyle = '#e9f4f2';
  context.fillRect(0, 0, 200, 150);
  for (let x = 0; x < 20; x++) {
    for (let y = 0; y < 15; y++) {
      const shade = 45 + 8 * ((7 * x + 3 * y) % 3);
      const isBorder = Math.min(x, y, 19 - x, 14 - y) === 1;
      context.fillStyle = isBorder ? `hsl(24 85% ${shade + 10}%)` : `hsl(188 60% ${shade}%)`;
      context.fillRect(10 * x + 0.5, 10 * y + 0.5, 9, 9);
    }
  }
  return canvas;
}

/** Where the drop fell, in the plane of the image, and how long ago. */
const drop = uniform(new Vector2(-0.1, 0));
const ageS = uniform(0.75);

// Rings run outwards at 0.6 units a second. They end at the first ring, and fade with time.
const distance = length(splatPosition.xy.sub(drop));
const behindFront = ageS.mul(0.6).sub(distance);
const strength = exp(behindFront.max(0).mul(-4)).mul(exp(ageS.mul(-0.6)));
const isReached = behindFront.mul(12).add(0.5).clamp(0, 1);
const wave = cos(behindFront.mul(32)).mul(strength).mul(isReached);
const ripple = splatNode({
  position: splatPosition.add(vec3(0, 0, wave.mul(0.09))),
  color: splatColor.mul(float(1).add(wave.mul(0.8))),
  reach: { displacement: 0.09 },
});
const effects = [ripple];

export default function Ripples() {
  const [image] = useState(() => makeSplatData(splatsFromImage(paintTiles())));
  const [isMoving, setMoving] = useState(!prefersStillness);
  const fall = (x: number, y: number) => {
    drop.value.set(x, y);
    ageS.value = 0;
    setMoving(true);
  };
  return (
    <>
      <SplatCanvas
        flat
        frameloop={isMoving ? 'always' : 'demand'}
        camera={{ position: [0, 0.75, 1], fov: 50, near: 0.05 }}
      >
        <Splats
          src={image}
          effects={effects}
          rotation-x={-Math.PI / 2}
          onClick={({ object, point }) => {
            const { x, y } = object.worldToLocal(point.clone());
            fall(x, y);
          }}
        />
        {isMoving && <Ageing />}
        <OrbitControls target={[0, 0, 0.07]} />
      </SplatCanvas>
      <form className="panel">
        <span>Click the water.</span>
        <button type="button" onClick={() => fall(Math.random() - 0.5, 0.7 * (Math.random() - 0.5))}>
          A drop
        </button>
      </form>
    </>
  );
}

function Ageing() {
  useFrame((_state, elapsedS) => {
    ageS.value += elapsedS;
  });
  return null;
}
