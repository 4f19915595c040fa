import { OrbitControls, useGLTF } from '@react-three/drei';
import { SplatCanvas } from '@websplatter/react';
import { SplatGltfPlugin } from '@websplatter/react/gltf';
import { Suspense } from 'react';

export default function GltfScene() {
  return (
    <SplatCanvas flat camera={{ position: [1.2, 1.1, 2.6], fov: 50, near: 0.05 }}>
      <ambientLight intensity={1} />
      <directionalLight position={[2, 3, 1]} intensity={3} />
      <Suspense>
        <Scene />
      </Suspense>
      <OrbitControls />
    </SplatCanvas>
  );
}

/** One file with a ring of splats and a mesh column, placed by its nodes. */
function Scene() {
  const { scene } = useGLTF('column.glb', false, false, (loader) => {
    loader.register((parser) => new SplatGltfPlugin(parser));
  });
  return <primitive object={scene} />;
}
