import type { SceneCamera } from '@websplatter/scenes';
import * as THREE from 'three/webgpu';

/** A renderer of three's as all adapters set it up, with an empty scene. */
export function threeScene(renderer: THREE.WebGPURenderer, canvas: HTMLCanvasElement) {
  const { width, height } = canvas;
  renderer.setPixelRatio(1);
  renderer.setSize(width, height, false);
  renderer.setClearColor(0x000000, 1);
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera();
  camera.aspect = width / height;
  return {
    scene,
    camera,
    setCamera: ({ position, target, up, fovYDegrees, near, far }: SceneCamera) => {
      camera.position.set(...position);
      camera.up.set(...up);
      camera.lookAt(...target);
      Object.assign(camera, { fov: fovYDegrees, near, far });
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
    },
    draw: () => {
      renderer.render(scene, camera);
    },
  };
}
