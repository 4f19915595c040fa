import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats, type Volume } from '@websplatter/react';
import { Suspense, useState } from 'react';

/** Heights at which the island is cut: above the sea, the beach, the woods and the rocks. */
const CUTS = [-0.01, 0.06, 0.16, 0.29];

/**
 * Returns a half-space above each cut, which lifts the splats in it. The highest comes first: lower
 * ones would have moved splats across its cut.
 */
const liftedBy = (gap: number) =>
  CUTS.toReversed().map(
    (height): Volume => ({
      ...{ shape: 'plane', point: [0, height, 0], normal: [0, 1, 0] },
      ...{ mode: 'displace', offset: [0, gap, 0] },
    }),
  );

export default function ExplodedView() {
  const [gap, setGap] = useState(0.12);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.6, 0.75, 2.1], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="terrain.ply" volumes={liftedBy(gap)} />
        </Suspense>
        <OrbitControls target={[0, 0.32, 0]} />
      </SplatCanvas>
      <form className="panel">
        <label>
          Gap
          <input
            type="range"
            min={0}
            max={0.2}
            step="any"
            value={gap}
            onChange={(event) => setGap(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}
