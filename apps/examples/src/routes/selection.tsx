import { invalidate, type ThreeEvent } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject, SplatSelection, Splats } from '@websplatter/react';
import { Suspense, useRef, useState } from 'react';
import { Sphere } from 'three';

export default function Selection() {
  const splats = useRef<SplatCloudObject>(null);
  const [selection] = useState(() => new SplatSelection());
  const [color, setColor] = useState('#ff8a00');
  const [radius, setRadius] = useState(0.2);
  const [count, setCount] = useState(0);
  // The selection is changed in place; the next frame shows it.
  const show = () => {
    setCount(selection.size);
    invalidate();
  };
  const select = async (event: ThreeEvent<MouseEvent>) => {
    const object = splats.current;
    const hit = await object?.pickAt(event);
    if (!object?.data || !hit) return;
    selection.add(await object.data.rowsIn(new Sphere(object.worldToLocal(hit.point), radius)));
    show();
  };
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats
            ref={splats}
            src="figures.ply"
            highlight={{ selection, color, strength: 0.75 }}
            onClick={select}
          />
        </Suspense>
      </SplatCanvas>
      <form className="panel">
        <output>{count === 0 ? 'Click on something.' : `${count.toLocaleString('en')} selected`}</output>
        <label>
          Radius
          <input
            type="range"
            min={0.02}
            max={0.4}
            step="any"
            value={radius}
            onChange={(event) => setRadius(event.target.valueAsNumber)}
          />
        </label>
        <label>
          Colour
          <input type="color" value={color} onChange={(event) => setColor(event.target.value)} />
        </label>
        <button
          type="button"
          onClick={() => {
            selection.clear();
            show();
          }}
        >
          Clear
        </button>
      </form>
    </>
  );
}
