import { SplatCanvas, Splats } from '@websplatter/react';
import { useState } from 'react';

export default function DepthOfField() {
  const [focusDistance, setFocusDistance] = useState(1.02);
  const [aperture, setAperture] = useState(0.1);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [-0.52, 0.4, 1.12], fov: 42, near: 0.05 }}>
        <Splats src="figures.ply" depthOfField={{ focusDistance, aperture }} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Depth in focus
          <input
            type="range"
            min={0.3}
            max={2}
            step="any"
            defaultValue={focusDistance}
            onInput={(event) => setFocusDistance(event.currentTarget.valueAsNumber)}
          />
        </label>
        <label>
          Aperture
          <input
            type="range"
            min={0}
            max={0.15}
            step="any"
            defaultValue={aperture}
            onInput={(event) => setAperture(event.currentTarget.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}
