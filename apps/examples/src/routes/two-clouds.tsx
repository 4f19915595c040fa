import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { useState } from 'react';

export default function TwoClouds() {
  const [opacity, setOpacity] = useState(1);
  return (
    <>
      <SplatCanvas flat camera={{ position: [0, 1.3, 4], fov: 50 }}>
        <Splats src="ring.ply" position-x={-0.55} />
        {/* Turned, mirrored and smaller. The file is read once and uploaded once. */}
        <Splats
          src="ring.ply"
          position-x={0.55}
          rotation-x={Math.PI / 2}
          scale={[-0.85, 0.85, 0.85]}
          opacity={opacity}
        />
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Opacity of the right ring
          <input
            type="range"
            min={0}
            max={1}
            step="any"
            value={opacity}
            onChange={(event) => setOpacity(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}
