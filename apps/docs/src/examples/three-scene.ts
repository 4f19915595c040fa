import { createSplatRenderer, SplatCloudObject, SplatLoader } from '@websplatter/three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Mesh, MeshBasicMaterial, PerspectiveCamera, Scene, SphereGeometry } from 'three/webgpu';

const canvas = document.body.appendChild(document.createElement('canvas'));
const renderer = await createSplatRenderer({ canvas, antialias: true });
const scene = new Scene();
const camera = new PerspectiveCamera(50, 1, 0.05, 400);
camera.position.set(0.12, 0.45, 1.44);
const controls = new OrbitControls(camera, canvas);

const loader = new SplatLoader().detectSupport(renderer);
scene.add(new SplatCloudObject(await loader.loadAsync('still-life.sog')));

// A mesh hides splats behind it, and splats in front veil it.
const ball = new Mesh(new SphereGeometry(0.06), new MeshBasicMaterial({ color: '#2f80ed' }));
ball.position.set(0.1, 0.25, 0.1);
scene.add(ball);

function resize() {
  renderer.setPixelRatio(devicePixelRatio);
  renderer.setSize(innerWidth, innerHeight);
  camera.aspect = innerWidth / innerHeight;
  camera.updateProjectionMatrix();
}

addEventListener('resize', resize);
resize();
renderer.setAnimationLoop(() => {
  controls.update();
  renderer.render(scene, camera);
});
