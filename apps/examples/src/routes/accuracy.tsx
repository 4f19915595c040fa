import { OrbitControls } from '@react-three/drei';
import { isAccuracyTarget } from '@websplatter/core';
import { type AccuracyChoice, type AccuracyRequest, SplatCanvas, Splats } from '@websplatter/react';
import { Suspense, useState } from 'react';

const REQUESTS = {
  Reference: 'reference',
  Balanced: 'balanced',
  Fast: 'fast',
  'Half the resolution': { resolutionScale: 0.5 },
  'At least 45 dB': { minPsnrDb: 45 },
  'At most 8 ms a frame': { maxFrameMs: 8 },
} as const satisfies Record<string, AccuracyRequest>;

type Request = keyof typeof REQUESTS;

export default function Accuracy() {
  const [request, setRequest] = useState<Request>('Balanced');
  const [choices, setChoices] = useState<Partial<Record<Request, AccuracyChoice>>>({});
  const keepChoice = (choice: AccuracyChoice) => setChoices((others) => ({ ...others, [request]: choice }));
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Suspense>
          <Splats src="terrain.ply" accuracy={REQUESTS[request]} onAccuracyChosen={keepChoice} />
        </Suspense>
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <label>
          Accuracy
          <select value={request} onChange={(event) => setRequest(event.target.value as Request)}>
            {Object.keys(REQUESTS).map((name) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        </label>
        {isAccuracyTarget(REQUESTS[request]) && (
          <output>{choices[request]?.why ?? 'Measuring which settings meet that…'}</output>
        )}
      </form>
    </>
  );
}
