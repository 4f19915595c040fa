import { OrbitControls } from '@react-three/drei';
import { useFrame } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject } from '@websplatter/react';
import { SplatInstances } from '@websplatter/react/components';
import { Suspense, useRef, useState } from 'react';
import { Matrix4 } from 'three';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const COUNT = 300;
const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));

const matrix = new Matrix4();
const tints = Array.from({ length: COUNT }, (_, i) => `hsl(${(360 * (i % 21)) / 21}, 75%, 62%)`);

/** Writes the matrix of each figure: position in a field, size, and rotation. */
function place(matrices: Float32Array, angle: number) {
  for (let i = 0; i < COUNT; i++) {
    const distance = 0.13 * Math.sqrt(i + 0.5);
    const size = 0.45 + 0.25 * Math.sin(distance * 5 - angle);
    const around = i * GOLDEN_ANGLE + 0.2 * angle;
    matrix.makeScale(size, size, size);
    matrix.setPosition(distance * Math.cos(around), 0, distance * Math.sin(around));
    matrix.toArray(matrices, 16 * i);
  }
  return matrices;
}

const MATRICES = place(new Float32Array(16 * COUNT), 0);

export default function Instances() {
  const [isMoving, setMoving] = useState(!prefersStillness);
  return (
    <>
      <SplatCanvas
        flat
        frameloop={isMoving ? 'always' : 'demand'}
        camera={{ position: [0, 1.5, 2.9], fov: 50, near: 0.05 }}
      >
        <Suspense>
          <Field isMoving={isMoving} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <span>{COUNT} figures, uploaded once</span>
        <label>
          <input type="checkbox" checked={isMoving} onChange={() => setMoving(!isMoving)} /> Moving
        </label>
      </form>
    </>
  );
}

function Field({ isMoving }: { isMoving: boolean }) {
  const figures = useRef<SplatCloudObject>(null);
  const angle = useRef(0);
  useFrame((_state, elapsedS) => {
    const instances = figures.current?.instances;
    if (!isMoving || !instances) return;
    angle.current += Math.min(elapsedS, 0.1);
    place(instances.matrices, angle.current);
    instances.needsUpdate = true;
  });
  return <SplatInstances ref={figures} src="figure.ply" matrices={MATRICES} tints={tints} />;
}
