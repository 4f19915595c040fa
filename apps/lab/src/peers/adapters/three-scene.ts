import type { SceneCamera } from '@websplatter/scenes';
import * as THREE from 'three/webgpu';

/** Parameters of a renderer by options of the page's URL: `msaa`. */
export function threeOptions(options: URLSearchParams): { readonly antialias: boolean } {
  return { antialias: options.has('msaa') };
}

/**
 * A renderer of three's as all adapters set it up, with an empty scene; with the option `mesh`, a
 * sphere stands at the camera's target.
 */
export function threeScene(
  renderer: THREE.WebGPURenderer,
  canvas: HTMLCanvasElement,
  options: URLSearchParams,
) {
  const { width, height } = canvas;
  renderer.setPixelRatio(1);
  renderer.setSize(width, height, false);
  renderer.setClearColor(0x000000, 1);
  const scene = new THREE.Scene();
  const mesh = new THREE.Mesh(new THREE.SphereGeometry(), new THREE.MeshNormalMaterial());
  if (options.has('mesh')) scene.add(mesh);
  const { camera, setCamera } = threeCamera(canvas);
  return {
    scene,
    camera,
    setCamera: (by: SceneCamera) => {
      setCamera(by);
      mesh.position.set(...by.target);
      mesh.scale.setScalar(camera.position.distanceTo(mesh.position) / 10);
    },
    draw: () => {
      renderer.render(scene, camera);
    },
  };
}

/** A camera of three's for a canvas, and how it follows the page's. */
export function threeCamera({ width, height }: HTMLCanvasElement) {
  const camera = new THREE.PerspectiveCamera();
  camera.aspect = width / height;
  return {
    camera,
    setCamera: ({ position, target, up, fovYDegrees, near, far }: SceneCamera) => {
      camera.position.set(...position);
      camera.up.set(...up);
      camera.lookAt(...target);
      Object.assign(camera, { fov: fovYDegrees, near, far });
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
    },
  };
}
