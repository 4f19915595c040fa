import { useFrame } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { PerspectiveCamera } from 'three';

const VIEWS = [
  { name: 'Front', camera: lookFrom(0.1, 0.45, 1.5) },
  { name: 'Left', camera: lookFrom(-1.45, 0.5, 0.6) },
  { name: 'Above', camera: lookFrom(0, 1.8, 0.3) },
];

export default function SeveralViews() {
  return (
    <>
      <SplatCanvas flat>
        <Splats src="still-life.sog" />
        <Views />
      </SplatCanvas>
      <ul className="view-names">
        {VIEWS.map(({ name }) => (
          <li key={name} className="view-name">
            {name}
          </li>
        ))}
      </ul>
    </>
  );
}

/**
 * Renders the scene once per camera. A priority above 0 replaces the Canvas's own rendering.
 * (drei's `<View>` does the same, but measures from the bottom, as WebGL does. With a
 * WebGPURenderer, views for the top of the page appear at its bottom.)
 */
function Views() {
  useFrame(({ gl, scene, size }) => {
    const isWide = size.width > size.height;
    const width = isWide ? size.width / VIEWS.length : size.width;
    const height = isWide ? size.height : size.height / VIEWS.length;
    gl.setScissorTest(true);
    VIEWS.forEach(({ camera }, i) => {
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      const [x, y] = isWide ? [i * width, 0] : [0, i * height];
      gl.setViewport(x, y, width, height);
      gl.setScissor(x, y, width, height);
      gl.render(scene, camera);
    });
    gl.setScissorTest(false);
  }, 1);
  return null;
}

function lookFrom(...position: [x: number, y: number, z: number]): PerspectiveCamera {
  const camera = new PerspectiveCamera(45, 1, 0.05, 400);
  camera.position.set(...position);
  camera.lookAt(0, 0.2, 0);
  return camera;
}
