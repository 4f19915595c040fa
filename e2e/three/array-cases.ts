import { packCloud } from '@websplatter/core';
import { SplatCloudObject, SplatData, splatEngineOf } from '@websplatter/three';
import {
  ArrayCamera,
  HalfFloatType,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  RenderTarget,
  Vector4,
} from 'three/webgpu';
import { testScene } from '../test-scene.ts';
import { FakeXrSession } from './fake-xr.ts';
import {
  drawn,
  makeRenderer,
  newScene,
  newStage,
  type Pixels,
  SIZE_PX,
  type Stage,
  shotOf,
  targetPixels,
} from './stage.ts';

/** Distance of a person's eyes, in metres. */
const EYE_DISTANCE = 0.064;

/** Where the cameras of an array are. */
export interface ArrayOptions {
  readonly antialias?: boolean;
  /** `eyes`: beside each other, looking the same way. `apart`: from two sides. */
  readonly cameras: 'eyes' | 'apart';
  /** A red wall before a part of the splats. */
  readonly hasWall?: boolean;
}

/** A picture of one camera, with the camera. */
export interface CameraShot {
  readonly pixels: Pixels;
  readonly viewMatrix: number[];
  readonly projectionMatrix: number[];
  readonly near: number;
  readonly far: number;
}

function camerasOf(kind: ArrayOptions['cameras']): PerspectiveCamera[] {
  return [0, 1].map((i) => {
    const camera = new PerspectiveCamera(60, 1, 0.1, 100);
    camera.position.set(1, 0.5, 6);
    camera.lookAt(0.5, 0, 0);
    if (kind === 'eyes') camera.translateX((i - 0.5) * EYE_DISTANCE);
    else if (i === 1) {
      camera.position.set(-5, 1, -2);
      camera.lookAt(0.5, 0, 0);
    }
    const viewport = new Vector4(i * SIZE_PX, 0, SIZE_PX, SIZE_PX);
    return Object.assign(camera, { viewport });
  });
}

function addTestScene({ scene }: Pick<Stage, 'scene'>, hasWall: boolean): void {
  const data = new SplatData(packCloud(testScene(), { geometryPrecision: 'packed' }), 'test scene');
  const cloud = new SplatCloudObject(data);
  cloud.accuracy = { rasterizer: 'tiles' };
  scene.add(cloud);
  if (!hasWall) return;
  const wall = new Mesh(new PlaneGeometry(1, 4), new MeshBasicMaterial({ color: 0xff0000 }));
  wall.position.set(0.5, 0, 2);
  scene.add(wall);
}

/** An array of `cameras`, brought up to date as applications do. */
function arrayOf(cameras: PerspectiveCamera[]): ArrayCamera {
  for (const camera of cameras) camera.updateMatrixWorld();
  const array = new ArrayCamera(cameras);
  array.position.copy(cameras[0].position);
  array.quaternion.copy(cameras[0].quaternion);
  array.updateMatrixWorld();
  return array;
}

function shotBy(camera: PerspectiveCamera, pixels: Pixels): CameraShot {
  const { matrixWorldInverse, projectionMatrix, near, far } = camera;
  return {
    pixels,
    viewMatrix: [...matrixWorldInverse.elements],
    projectionMatrix: [...projectionMatrix.elements],
    near,
    far,
  };
}

function partOf({ widthPx, data }: Pixels, left: number): Pixels {
  const rows = Array.from({ length: SIZE_PX }, (_, y) =>
    data.slice(4 * (y * widthPx + left), 4 * (y * widthPx + left + SIZE_PX)),
  );
  return { widthPx: SIZE_PX, heightPx: SIZE_PX, data: rows.flat() };
}

/** The pictures of the same cameras, each drawn by itself. */
async function shotsAlone(stage: Stage, cameras: readonly PerspectiveCamera[]): Promise<Pixels[]> {
  const shots: Pixels[] = [];
  stage.renderer.setSize(SIZE_PX, SIZE_PX, false);
  for (const camera of cameras)
    shots.push(await shotOf(stage, () => stage.renderer.render(stage.scene, camera)));
  return shots;
}

/** Run by name from the tests. */
export const arrayCases = {
  /** Both cameras of an ArrayCamera in viewports of a canvas, and alone. */
  arrayViewports: async ({ cameras: kind, hasWall = false, ...parameters }: ArrayOptions) => {
    const stage = await newStage(parameters);
    const { renderer, scene } = stage;
    addTestScene(stage, hasWall);
    const cameras = camerasOf(kind);
    const array = arrayOf(cameras);
    renderer.setSize(2 * SIZE_PX, SIZE_PX, false);
    const whole = await shotOf(stage, () => renderer.render(scene, array), 2);
    const shots = cameras.map((camera, i) => shotBy(camera, partOf(whole, i * SIZE_PX)));
    return { shots, alone: await shotsAlone(stage, cameras) };
  },

  /** The same in layers of a render target: linear colours. */
  arrayLayers: async ({ cameras: kind, hasWall = false }: ArrayOptions, samples: number) => {
    const stage = await newStage();
    const { renderer, scene } = stage;
    addTestScene(stage, hasWall);
    const cameras = camerasOf(kind);
    const array = arrayOf(cameras);
    const target = new RenderTarget(SIZE_PX, SIZE_PX, {
      type: HalfFloatType,
      samples,
      depth: 2,
      useArrayDepthTexture: true,
    });
    await drawn(
      renderer,
      scene,
      () => {
        renderer.setRenderTarget(target);
        renderer.render(scene, array);
        renderer.setRenderTarget(null);
      },
      2,
    );
    const shots: CameraShot[] = [];
    for (const [i, camera] of cameras.entries())
      shots.push(shotBy(camera, await targetPixels(renderer, target, i)));
    target.dispose();
    return shots;
  },

  /** Both views of an XR session. */
  xrSession: async ({ cameras: kind, hasWall = false }: ArrayOptions) => {
    const renderer = await makeRenderer({});
    renderer.setSize(SIZE_PX, SIZE_PX, false);
    const stage = { renderer, ...newScene() };
    addTestScene(stage, hasWall);
    const cameras = camerasOf(kind);
    for (const camera of cameras) {
      // As a WebGPU session gives it: clip depth from 0 to 1.
      camera.coordinateSystem = renderer.coordinateSystem;
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
    }
    const session = new FakeXrSession(cameras, SIZE_PX);
    const user = new PerspectiveCamera(60, 1, 0.1, 100);
    void renderer.setAnimationLoop(() => renderer.render(stage.scene, user));
    await session.begin(renderer);
    await drawn(renderer, stage.scene, () => session.drawFrame(), 2);
    const { device } = splatEngineOf(renderer);
    const shots: CameraShot[] = [];
    for (const [i, camera] of cameras.entries()) {
      const pixels = { widthPx: SIZE_PX, heightPx: SIZE_PX, data: await session.pixels(i, device) };
      shots.push(shotBy(camera, pixels));
    }
    void renderer.setAnimationLoop(null);
    session.end();
    await renderer.dispose();
    return shots;
  },
};
