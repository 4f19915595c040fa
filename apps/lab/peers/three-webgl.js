import * as THREE from 'three';

/** three's WebGL renderer as the adapters here set it up, with an empty scene. */
export function threeWebGl(canvas) {
  const { width, height } = canvas;
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: false });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height, false);
  renderer.setClearColor(0x000000, 1);
  const camera = new THREE.PerspectiveCamera();
  camera.aspect = width / height;
  /** @type {import('../src/peers/adapter.ts').Peer['setCamera']} */
  const setCamera = ({ position, target, up, fovYDegrees, near, far }) => {
    camera.position.set(...position);
    camera.up.set(...up);
    camera.lookAt(...target);
    Object.assign(camera, { fov: fovYDegrees, near, far });
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  };
  return { renderer, camera, setCamera };
}
