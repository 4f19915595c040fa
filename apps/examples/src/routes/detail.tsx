import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

const percent = new Intl.NumberFormat(undefined, { style: 'percent', maximumSignificantDigits: 2 });

export default function Detail() {
  // An exponent: each step of the slider halves the number of splats.
  const [halvings, setHalvings] = useState(5);
  const maxShare = 2 ** -halvings;
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" detail={{ maxShare }} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          At most {percent.format(maxShare)} of the splats
          <input
            type="range"
            min={0}
            max={8}
            step="any"
            value={halvings}
            onChange={(event) => setHalvings(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}
