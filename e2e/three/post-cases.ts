import { packCloud } from '@websplatter/core';
import { type Volume, volumes } from '@websplatter/core/effects';
import { SplatCloudObject, SplatData, splatEngineOf, volumeOf } from '@websplatter/three';
import { PATIENCE_MS } from '@websplatter/tools/patience';
import { ao } from 'three/addons/tsl/display/GTAONode.js';
import { traa } from 'three/addons/tsl/display/TRAANode.js';
import {
  colorToDirection,
  directionToColor,
  mrt,
  normalView,
  output,
  pass,
  sample,
  vec3,
  vec4,
  velocity,
} from 'three/tsl';
import {
  AmbientLight,
  BoxGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  type PerspectiveCamera,
  Plane,
  PlaneGeometry,
  RenderPipeline,
  Vector3,
} from 'three/webgpu';
import { testScene } from '../test-scene.ts';
import {
  canvasPixels,
  newStage,
  nextFrame,
  type Pixels,
  type RendererParameters,
  SIZE_PX,
  type Stage,
  shot,
  targetPixels,
} from './stage.ts';

/** Moving objects between two frames. */
type MotionKind = 'nothing' | 'camera' | 'cloud' | 'everything';

/** From where a frame is seen, and where its clouds are. */
export interface FramePose {
  readonly viewMatrix: readonly number[];
  readonly projectionMatrix: readonly number[];
  readonly modelMatrices: readonly (readonly number[])[];
}

/** Depth of the wall behind the clouds, z in world space. */
const WALL_Z = -4;

const PANE = { color: 0x3fa7ff, opacity: 0.6 };

/** Pixels of a finer image per pixel and axis. */
const SUPERSAMPLING = 4;

function cloudOfTestScene(): SplatCloudObject {
  return new SplatCloudObject(
    new SplatData(packCloud(testScene(), { geometryPrecision: 'f32' }), 'test scene'),
  );
}

export const postCases = {
  /** Two clouds before a wall, and the output for three's velocity after something has moved. */
  motion: async (moves: MotionKind, parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const { renderer, scene, camera } = stage;
    const clouds = moves === 'cloud' ? [cloudOfTestScene()] : [cloudOfTestScene(), cloudOfTestScene()];
    for (const cloud of clouds) {
      cloud.depthWrite = true;
      cloud.accuracy = 'reference';
      cloud.scale.setScalar(0.4);
    }
    clouds[0].position.set(-1.4, -0.3, 0);
    clouds[1]?.position.set(0.4, -0.6, -0.5);
    const wall = new Mesh(new PlaneGeometry(40, 40), new MeshBasicMaterial());
    wall.position.z = WALL_Z;
    scene.add(...clouds, wall);
    const scenePass = pass(scene, camera);
    scenePass.setMRT(mrt({ output, velocity }));
    // 0.185 draws only outputs that somebody has asked for.
    scenePass.getTextureNode('velocity');
    const pipeline = new RenderPipeline(renderer, scenePass.getTextureNode('output'));
    const pose = (): FramePose => ({
      viewMatrix: [...camera.matrixWorldInverse.elements],
      projectionMatrix: [...camera.projectionMatrix.elements],
      modelMatrices: clouds.map(({ matrixWorld }) => [...matrixWorld.elements]),
    });
    // Compiles the splats' shaders.
    await shot(stage);
    await passShot(stage, pipeline);
    const before = pose();
    if (moves === 'camera' || moves === 'everything') {
      camera.position.set(0.15, 0.05, 2.9);
      camera.rotation.set(0.01, 0.04, 0.02);
    }
    if (moves === 'cloud' || moves === 'everything') clouds[0].rotation.set(0, 0.1, 0.1);
    if (moves === 'everything') clouds[1].position.y += 0.1;
    if (moves === 'nothing') jitter(camera);
    await passShot(stage, pipeline);
    velocity.setProjectionMatrix(null);
    const { renderTarget } = scenePass;
    const index = renderTarget.textures.findIndex(({ name }) => name === 'velocity');
    const found = await targetPixels(renderer, renderTarget, 0, index);
    return { before, after: pose(), velocity: found, near: camera.near, far: camera.far, wallZ: WALL_Z };
  },

  /** Splats behind a tilted pane that fills the image, the pane, splats before it: two objects. */
  paneInCloud: async (cameraZ: number) => {
    const stage = await newStage();
    const { scene, camera } = stage;
    camera.position.z = cameraZ;
    camera.lookAt(0, 0, 0);
    const pane = new Mesh(
      new PlaneGeometry(60, 60),
      new MeshBasicMaterial({ ...PANE, transparent: true, depthWrite: false, side: DoubleSide }),
    );
    pane.rotation.y = 0.9;
    const plane = new Plane().setFromNormalAndCoplanarPoint(
      new Vector3(0, 0, 1).applyEuler(pane.rotation),
      pane.position,
    );
    const data = new SplatData(packCloud(testScene(), { geometryPrecision: 'f32' }), 'test scene');
    const clouds = [-1, 1].map((renderOrder) => {
      const cloud = new SplatCloudObject(data);
      cloud.accuracy = { preset: 'reference', rasterizer: 'tiles' };
      cloud.scale.setScalar(0.7);
      cloud.position.set(-0.9, -0.7, 0);
      cloud.renderOrder = renderOrder;
      // Before the pane are splats on the camera's side.
      const isCamerasSide = renderOrder > 0;
      const isKept = isCamerasSide === plane.distanceToPoint(camera.position) > 0;
      cloud.effects = [volumes([volumeOf(isKept ? plane : plane.clone().negate())])];
      return cloud;
    });
    scene.add(...clouds, pane);
    const image = await shot(stage, 2);
    return {
      image,
      viewMatrix: [...camera.matrixWorldInverse.elements],
      projectionMatrix: [...camera.projectionMatrix.elements],
      near: camera.near,
      far: camera.far,
      modelMatrix: [...clouds[0].matrixWorld.elements],
      /** Splats behind the pane, and before it. */
      volumes: clouds.map(({ effects: [{ options }] }) => options as readonly Volume[]),
      pane: { color: new Color(PANE.color).toArray(), opacity: PANE.opacity },
    };
  },

  /** Three's ambient occlusion of a box and a cloud over a floor; null: without the cloud. */
  occlusion: async (depthWrite: boolean | null) => {
    const stage = await overFloor(depthWrite);
    const { renderer, scene, camera } = stage;
    const scenePass = pass(scene, camera);
    scenePass.setMRT(mrt({ output, normal: directionToColor(normalView) }));
    const [depth, normals] = ['depth', 'normal'].map((name) => scenePass.getTextureNode(name));
    // 0.185 draws only outputs that somebody has asked for.
    scenePass.getTextureNode('output');
    const normal = sample((uv) => colorToDirection(normals.sample(uv)));
    const occlusion = vec4(vec3(ao(depth, normal, camera).getTextureNode().r), 1);
    return passShot(stage, new RenderPipeline(renderer, occlusion), depthWrite !== null);
  },

  /**
   * The test scene in three's TRAA after `frames` frames in which the camera moves by `step` each,
   * with the motion of splats or as if nothing moved; the same without TRAA; and on request with
   * more pixels.
   */
  temporal: async (frames: number, step: number, hasMotion: boolean, isFineDrawn = false) => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const cloud = cloudOfTestScene();
    cloud.depthWrite = true;
    cloud.accuracy = { preset: 'reference', rasterizer: 'tiles' };
    cloud.scale.setScalar(0.7);
    cloud.position.set(-0.6, -0.8, 0);
    const wall = new Mesh(new PlaneGeometry(40, 40), new MeshBasicMaterial({ color: 0x334455 }));
    wall.position.z = WALL_Z;
    scene.add(cloud, wall);
    const scenePass = pass(scene, camera);
    scenePass.setMRT(mrt({ output, velocity, still: vec4(0) }));
    const motion = scenePass.getTextureNode(hasMotion ? 'velocity' : 'still');
    const image = scenePass.getTextureNode('output');
    const temporal = traa(image, scenePass.getTextureNode('depth'), motion, camera);
    const pipeline = new RenderPipeline(renderer, temporal);
    await shot(stage);
    camera.position.x -= frames * step;
    let result: Pixels | null = null;
    for (let frame = 0; frame < frames; frame++) {
      camera.position.x += step;
      result = await passShot(stage, pipeline);
    }
    const plain = await shot(stage);
    renderer.setSize(SUPERSAMPLING * SIZE_PX, SUPERSAMPLING * SIZE_PX, false);
    const fine = isFineDrawn ? await shot(stage) : null;
    return { temporal: result!, plain, fine };
  },
};

/** The canvas after `pipeline` drew splats, in a new frame: three draws a pass once in each. */
async function passShot({ renderer }: Stage, pipeline: RenderPipeline, hasSplats = true): Promise<Pixels> {
  const engine = splatEngineOf(renderer);
  const before = engine.counters().framesDrawn;
  const endMs = performance.now() + PATIENCE_MS;
  while (performance.now() < endMs) {
    await nextFrame();
    pipeline.render();
    const pixels = canvasPixels(renderer);
    if (!hasSplats || engine.counters().framesDrawn > before) return pixels;
  }
  throw new Error('The splats were never drawn in a pass.');
}

/** A box and, if asked for, a cloud over a floor. */
async function overFloor(depthWrite: boolean | null): Promise<Stage> {
  const stage = await newStage();
  const { scene, camera } = stage;
  const floor = new Mesh(new PlaneGeometry(20, 20), new MeshStandardMaterial());
  floor.rotation.x = -Math.PI / 2;
  floor.position.y = -1;
  const box = new Mesh(new BoxGeometry(), new MeshStandardMaterial({ color: 0xcc3322 }));
  box.position.set(-1.1, -0.5, -0.5);
  const sun = new DirectionalLight(0xffffff, 3);
  sun.position.set(1, 2, 2);
  scene.add(floor, box, sun, new AmbientLight(0xffffff, 1));
  camera.position.y = 0.5;
  camera.lookAt(0, -0.3, 0);
  if (depthWrite === null) return stage;
  const cloud = cloudOfTestScene();
  cloud.depthWrite = depthWrite;
  cloud.accuracy = { preset: 'reference', rasterizer: 'tiles' };
  cloud.scale.setScalar(0.5);
  cloud.position.set(0.3, -0.9, 0);
  scene.add(cloud);
  return stage;
}

/** Moves the image by parts of a pixel, as TRAA does, and tells three. */
function jitter(camera: PerspectiveCamera): void {
  velocity.setProjectionMatrix(new Matrix4().copy(camera.projectionMatrix));
  camera.setViewOffset(SIZE_PX, SIZE_PX, 0.3, -0.4, SIZE_PX, SIZE_PX);
}
