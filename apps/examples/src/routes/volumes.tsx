import { OrbitControls, TransformControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { SplatVolume, type SplatVolumeObject, type SplatVolumeProps } from '@websplatter/react/components';
import { Suspense, useState } from 'react';

/** A bite out of the bread, a warm light on the vase, and a bottle in the air. */
const VOLUMES = {
  Eraser: { shape: 'sphere', mode: 'hide', radius: 0.09, position: [-0.24, 0.07, 0.22] },
  Lift: {
    ...{ shape: 'capsule', mode: 'displace', offset: [0, 0.2, 0] },
    ...{ radius: 0.08, height: 0.2, position: [0.02, 0.19, -0.29] },
  },
  Lamp: {
    ...{ shape: 'ellipsoid', mode: 'tint', tint: [1.9, 0.9, 0.6], softEdge: 0.05 },
    ...{ size: [0.3, 0.4, 0.3], position: [-0.2, 0.15, -0.15] },
  },
} satisfies Record<string, SplatVolumeProps>;

type Name = keyof typeof VOLUMES;

export default function Volumes() {
  const [moved, setMoved] = useState<Name | 'None'>('None');
  const [objects, setObjects] = useState<Partial<Record<Name, SplatVolumeObject>>>({});
  const target = moved === 'None' ? undefined : objects[moved];
  const [eraserEdge, setEraserEdge] = useState(0.02);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" />
        </Suspense>
        {(Object.keys(VOLUMES) as Name[]).map((name) => (
          <SplatVolume
            key={name}
            {...VOLUMES[name]}
            {...(name === 'Eraser' && { softEdge: eraserEdge })}
            name={name}
            ref={(object) => {
              if (object && objects[name] !== object) setObjects((all) => ({ ...all, [name]: object }));
            }}
          />
        ))}
        {target && <TransformControls object={target} size={0.6} />}
        <OrbitControls makeDefault />
      </SplatCanvas>
      <form className="panel">
        <label>
          Move
          <select value={moved} onChange={(event) => setMoved(event.target.value as Name | 'None')}>
            {['None', ...Object.keys(VOLUMES)].map((name) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        </label>
        <label>
          Eraser’s soft edge
          <input
            type="range"
            min={0}
            max={0.2}
            step="any"
            value={eraserEdge}
            onChange={(event) => setEraserEdge(event.target.valueAsNumber)}
          />
        </label>
      </form>
    </>
  );
}
