import type { ThreeEvent } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject, type SplatHit, Splats } from '@websplatter/react';
import { useRef, useState } from 'react';

export default function Picking() {
  const splats = useRef<SplatCloudObject>(null);
  const [hit, setHit] = useState<SplatHit | null>(null);
  const pick = async (event: ThreeEvent<MouseEvent>) => {
    setHit((await splats.current?.pickAt(event)) ?? null);
  };
  return (
    <>
      <SplatCanvas flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
        <Splats ref={splats} src="figures.ply" onClick={pick} />
        {hit && (
          <mesh position={hit.point} renderOrder={1}>
            <sphereGeometry args={[0.012 * hit.depthView]} />
            {/* Drawn after the splats and over all: others may hide the picked splat's centre. */}
            <meshBasicMaterial color="#ff2d87" transparent depthTest={false} />
          </mesh>
        )}
      </SplatCanvas>
      <p className="panel" role="status">
        {hit
          ? `Row ${hit.row.toLocaleString('en')} · depth ${hit.depthView.toFixed(3)} · opacity ${hit.alpha.toFixed(2)}`
          : 'Click a splat.'}
      </p>
    </>
  );
}
