import { OrbitControls } from '@react-three/drei';
import type { ShDegree } from '@websplatter/core';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

export default function Colour() {
  const [tint, setTint] = useState('#ffb27a');
  const [stops, setStops] = useState(0);
  const [opacity, setOpacity] = useState(1);
  const [shDegree, setShDegree] = useState<ShDegree>(3);
  const [antialias, setAntialias] = useState(false);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          {/* White, 1, 3 and false change nothing, so shaders do not contain these effects. */}
          <Splats
            src="still-life.sog"
            tint={tint}
            brightness={2 ** stops}
            opacity={opacity}
            shDegree={shDegree}
            antialias={antialias}
          />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Tint
          <input type="color" value={tint} onChange={(event) => setTint(event.target.value)} />
        </label>
        <label>
          Brightness
          <input
            type="range"
            min={-2}
            max={2}
            step="any"
            value={stops}
            onChange={(event) => setStops(event.target.valueAsNumber)}
          />
        </label>
        <label>
          Opacity
          <input
            type="range"
            min={0}
            max={1}
            step="any"
            value={opacity}
            onChange={(event) => setOpacity(event.target.valueAsNumber)}
          />
        </label>
        <label>
          <input
            type="checkbox"
            checked={shDegree > 0}
            onChange={({ target }) => setShDegree(target.checked ? 3 : 0)}
          />{' '}
          Colours depend on the view
        </label>
        <label>
          <input
            type="checkbox"
            checked={antialias}
            onChange={({ target }) => setAntialias(target.checked)}
          />{' '}
          Trained with antialiasing
        </label>
      </form>
    </>
  );
}
