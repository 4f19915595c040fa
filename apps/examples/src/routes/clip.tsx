import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats, type Volume } from '@websplatter/react';
import { Suspense, useState } from 'react';

/** Volumes by size: the position of a plane, the radius of a sphere, half the edge of a box. */
const SHAPES = {
  Plane: (size) => ({ mode: 'keep', shape: 'plane', point: [size, 0, 0], normal: [-1, 0, 0] }),
  Sphere: (size) => ({ mode: 'keep', shape: 'sphere', center: [0, 0.2, 0], radius: size }),
  Box: (size) => ({ mode: 'keep', shape: 'box', center: [0, 0.2, 0], size: [2 * size, 2 * size, 2 * size] }),
} satisfies Record<string, (size: number) => Volume>;

type Shape = keyof typeof SHAPES;

export default function Clip() {
  const [shape, setShape] = useState<Shape>('Plane');
  const [size, setSize] = useState(0.2);
  const [softEdge, setSoftEdge] = useState(0.05);
  const [invert, setInvert] = useState(false);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" volumes={[{ ...SHAPES[shape](size), softEdge, invert }]} />
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
          <input type="checkbox" checked={invert} onChange={({ target }) => setInvert(target.checked)} /> Keep
          the outside
        </label>
      </form>
    </>
  );
}
