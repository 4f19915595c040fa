import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';
import { SplatAnnotation, SplatMeasure } from '@websplatter/react/components';
import { Suspense, useState } from 'react';

const LABELS = [
  { name: 'Vase', position: [-0.2, 0.31, -0.12] },
  { name: 'Bowl', position: [0.2, 0.2, -0.04] },
  { name: 'Table', position: [0.05, 0.01, 0.45] },
] as const;

export default function Annotations() {
  const [chosen, setChosen] = useState('');
  const [distance, setDistance] = useState('');
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="still-life.sog" />
        </Suspense>
        {LABELS.map(({ name, position }) => (
          <SplatAnnotation key={name} position={[...position]}>
            <button type="button" className="label" onClick={() => setChosen(name)}>
              {name}
            </button>
          </SplatAnnotation>
        ))}
        <SplatMeasure
          unit={{ name: 'cm', perWorldUnit: 100, digits: 1 }}
          onMeasure={({ text }) => setDistance(text)}
        />
        <OrbitControls makeDefault />
      </SplatCanvas>
      <p className="panel">
        <span>{chosen ? `Chosen: ${chosen}.` : 'Labels hide behind what covers them.'}</span>
        <output>{distance ? `Measured: ${distance}.` : 'Click two points to measure.'}</output>
      </p>
    </>
  );
}
