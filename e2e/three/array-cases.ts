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
import { splatCloud } from './splats.ts';
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
  until,
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

/** A target with a layer for each of two cameras. */
function layeredTarget(samples = 0): RenderTarget {
  return new RenderTarget(SIZE_PX, SIZE_PX, {
    type: HalfFloatType,
    samples,
    depth: 2,
    useArrayDepthTexture: true,
  });
}

/** Renders into `target` until the splats of both cameras are drawn. */
async function drawnInto(
  { renderer, scene }: Stage,
  array: ArrayCamera,
  target: RenderTarget,
): Promise<void> {
  const draw = () => {
    renderer.setRenderTarget(target);
    renderer.render(scene, array);
    renderer.setRenderTarget(null);
  };
  await drawn(renderer, scene, draw, 2);
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
    const { renderer } = stage;
    addTestScene(stage, hasWall);
    const cameras = camerasOf(kind);
    const array = arrayOf(cameras);
    const target = layeredTarget(samples);
    await drawnInto(stage, array, target);
    const shots: CameraShot[] = [];
    for (const [i, camera] of cameras.entries())
      shots.push(shotBy(camera, await targetPixels(renderer, target, i)));
    target.dispose();
    return shots;
  },

  /** Splats that write depth before a wall drawn later, by both cameras: canvas and layers. */
  arrayDepth: async () => {
    const stage = await newStage();
    const { renderer, scene } = stage;
    const cloud = splatCloud({ opacity: 0.9 });
    cloud.depthWrite = true;
    const wall = new Mesh(new PlaneGeometry(50, 50), new MeshBasicMaterial({ color: 0x00ff00 }));
    wall.material.transparent = true;
    wall.renderOrder = 1;
    wall.position.z = -0.5;
    scene.add(cloud, wall);
    const array = arrayOf(camerasOf('eyes'));
    renderer.setSize(2 * SIZE_PX, SIZE_PX, false);
    const onCanvas = await shotOf(stage, () => renderer.render(scene, array), 2);
    const target = layeredTarget();
    await drawnInto(stage, array, target);
    const layers = [await targetPixels(renderer, target, 0), await targetPixels(renderer, target, 1)];
    target.dispose();
    return { onCanvas, layers };
  },

  /** The error of a cloud if three cannot be interrupted in a pass with layers. */
  arrayLayersRefused: async () => {
    const stage = await newStage();
    const { renderer, scene } = stage;
    const cloud = splatCloud({});
    const errors: string[] = [];
    cloud.onError = (error) => errors.push(`${error.name}: ${error.message}`);
    scene.add(cloud);
    const array = arrayOf(camerasOf('eyes'));
    const target = layeredTarget();
    // The code for several cameras, and then the words, are loaded.
    await until(() => {
      renderer.setRenderTarget(target);
      renderer.render(scene, array);
      renderer.setRenderTarget(null);
      return errors.length > 0;
    });
    target.dispose();
    return { errors, after: await shotOf(stage, () => renderer.render(scene, stage.camera)) };
  },

  /** Splats along the middle of the right camera's viewport, by the array and alone. */
  arrayPick: async () => {
    const stage = await newStage();
    const { renderer, scene } = stage;
    addTestScene(stage, false);
    const cloud = scene.children.find((child) => child instanceof SplatCloudObject)!;
    const cameras = camerasOf('eyes');
    const array = arrayOf(cameras);
    renderer.setSize(2 * SIZE_PX, SIZE_PX, false);
    await shotOf(stage, () => renderer.render(scene, array), 2);
    const picksFrom = async (leftPx: number) => {
      const found: (number | undefined)[] = [];
      for (let xPx = 4; xPx < SIZE_PX; xPx += 8)
        found.push((await cloud.pick(renderer, cameras[1], leftPx + xPx, SIZE_PX / 2))?.row);
      return found;
    };
    const byArray = await picksFrom(SIZE_PX);
    renderer.setSize(SIZE_PX, SIZE_PX, false);
    await shotOf(stage, () => renderer.render(scene, cameras[1]));
    return { byArray, alone: await picksFrom(0) };
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
