import { OrbitControls } from '@react-three/drei';
import { SplatCanvas, Splats } from '@websplatter/react';

export default function FirstSplat() {
  return (
    <SplatCanvas flat camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}>
      <Splats src="still-life.sog" />
      <OrbitControls />
    </SplatCanvas>
  );
}
