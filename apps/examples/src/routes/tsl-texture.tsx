import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { splatColor, splatNode, splatPositionWorld } from '@websplatter/react/tsl';
import { Suspense, useState } from 'react';
import { rotateUV, texture, uniform, vec4 } from 'three/tsl';
import { CanvasTexture, Matrix4, PerspectiveCamera, SRGBColorSpace } from 'three/webgpu';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const SIZE_PX = 512;
const PANES = 12;

/** A round window of coloured glass in black leads; a photograph would come from `TextureLoader`. */
function paintWindow(): OffscreenCanvas {
  const canvas = new OffscreenCanvas(SIZE_PX, SIZE_PX);
  const context = canvas.getContext('2d')!;
  context.fillRect(0, 0, SIZE_PX, SIZE_PX);
  context.translate(SIZE_PX / 2, SIZE_PX / 2);
  context.lineWidth = 7;
  for (const [ring, radius] of [0.46, 0.34, 0.21, 0.08].entries()) {
    for (let pane = 0; pane < PANES; pane++) {
      const turn = (2 * Math.PI) / PANES;
      const first = (pane + ring / 2) * turn;
      context.fillStyle = `hsl(${(360 * pane) / PANES + 75 * ring} 95% ${pane % 2 ? 62 : 50}%)`;
      context.beginPath();
      context.moveTo(0, 0);
      context.arc(0, 0, radius * SIZE_PX, first, first + turn);
      context.closePath();
      context.fill();
      context.stroke();
    }
  }
  return canvas;
}

const slide = new CanvasTexture(paintWindow());
slide.colorSpace = SRGBColorSpace;

const projector = new PerspectiveCamera(42, 1);
projector.position.set(0.35, 1.25, 1.25);
projector.lookAt(0, 0.12, 0);
projector.updateMatrixWorld();
const toSlide = uniform(
  new Matrix4().multiplyMatrices(projector.projectionMatrix, projector.matrixWorldInverse),
);

// Where the ray from the projector to the splat goes through the slide, 0…1.
const place = toSlide.mul(vec4(splatPositionWorld, 1));
const onSlide = place.xy.div(place.w).mul(0.5).add(0.5);
const angle = uniform(0);
const light = texture(slide, rotateUV(onSlide, angle)).rgb;

const brightness = uniform(2.5);
const projection = splatNode({ color: splatColor.mul(light.mul(brightness).add(0.06)) });
const effects = [projection];

export default function TslTexture() {
  const [isTurning, setTurning] = useState(!prefersStillness);
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.12, 0.65, 1.4], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" effects={effects} />
        </Suspense>
        {isTurning && <Turn />}
        <OrbitControls target={[0, 0.15, 0]} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Brightness
          <input
            type="range"
            min={0}
            max={5}
            step="any"
            defaultValue={brightness.value}
            onChange={(event) => {
              brightness.value = event.target.valueAsNumber;
            }}
          />
        </label>
        <label>
          <input type="checkbox" checked={isTurning} onChange={() => setTurning(!isTurning)} /> Turning
        </label>
      </form>
    </>
  );
}

/** Turns the slide. */
function Turn() {
  useFrame((_state, elapsedS) => {
    angle.value += 0.3 * elapsedS;
  });
  return null;
}
