import { OrbitControls } from '@react-three/drei';
import { type ClipVolume, SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

/** Volumes by size: the position of a plane, the radius of a sphere, half the edge of a box. */
const SHAPES = {
  Plane: (size) => ({ shape: 'plane', point: [size, 0, 0], normal: [-1, 0, 0] }),
  Sphere: (size) => ({ shape: 'sphere', center: [0, 0.2, 0], radius: size }),
  Box: (size) => ({ shape: 'box', center: [0, 0.2, 0], size: [2 * size, 2 * size, 2 * size] }),
} satisfies Record<string, (size: number) => ClipVolume>;

type Shape = keyof typeof SHAPES;

export default function Clip() {
  const [shape, setShape] = useState<Shape>('Plane');
  const [size, setSize] = useState(0.2);
  const [softEdge, setSoftEdge] = useState(0.05);
  const [keep, setKeep] = useState<'inside' | 'outside'>('inside');
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" clip={{ volumes: [{ ...SHAPES[shape](size), keep }], softEdge }} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Volume
          <select value={shape} onChange={(event) => setShape(event.target.value as Shape)}>
            {Object.keys(SHAPES).map((name) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        </label>
        <label>
          Size
          <input
            type="range"
            min={0.05}
            max={0.8}
            step="any"
            value={size}
            onChange={(event) => setSize(event.target.valueAsNumber)}
          />
        </label>
        <label>
          Soft edge
          <input
            type="range"
            min={0}
            max={0.4}
            step="any"
            value={softEdge}
            onChange={(event) => setSoftEdge(event.target.valueAsNumber)}
          />
        </label>
        <label>
          <input
            type="checkbox"
            checked={keep === 'outside'}
            onChange={({ target }) => setKeep(target.checked ? 'outside' : 'inside')}
          />{' '}
          Keep the outside
        </label>
      </form>
    </>
  );
}
