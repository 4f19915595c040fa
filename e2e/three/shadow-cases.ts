import { reveal } from '@websplatter/core/effects';
import { SplatCloudObject, SplatInstances, splatEngineOf } from '@websplatter/three';
import { editsOf } from '@websplatter/three/own-data';
import { PATIENCE_MS } from '@websplatter/tools/patience';
import {
  AmbientLight,
  BasicShadowMap,
  type Camera,
  DirectionalLight,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  type OrthographicCamera,
  type PerspectiveCamera,
  PlaneGeometry,
  SpotLight,
} from 'three/webgpu';
import { manySplats, splatCloud, splatData } from './splats.ts';
import {
  areOn,
  canvasPixels,
  meshShot,
  newStage,
  type Pixels,
  type RendererParameters,
  type Stage,
  shot,
  shotWith,
  until,
} from './stage.ts';

/** Cameras see this layer only where they say so. */
const UNSEEN = 1;
const MAP_PX = 96;
const EXACT: RendererParameters = { accuracy: 'high' };

export type LightKind = 'directional' | 'spot';

/** The matrices of a camera, for references. */
export interface CameraNumbers {
  readonly viewMatrix: readonly number[];
  readonly projectionMatrix: readonly number[];
  readonly near: number;
  readonly far: number;
}

function numbersOf(camera: Camera): CameraNumbers {
  const { matrixWorldInverse, projectionMatrix, near, far } = camera as
    | PerspectiveCamera
    | OrthographicCamera;
  const [viewMatrix, projection] = [matrixWorldInverse.elements, projectionMatrix.elements];
  return { viewMatrix: [...viewMatrix], projectionMatrix: [...projection], near, far };
}

/** A light above the right of the origin, whose map shows what no other camera sees. */
function addLight({ scene, renderer }: Stage, kind: LightKind): DirectionalLight | SpotLight {
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = BasicShadowMap;
  const light =
    kind === 'spot' ? new SpotLight(0xffeedd, 60, 0, 0.5, 0.3) : new DirectionalLight(0xffffff, 3);
  light.position.set(1.5, 2, 4);
  light.castShadow = true;
  light.shadow.mapSize.set(MAP_PX, MAP_PX);
  const { camera } = light.shadow;
  Object.assign(camera, { near: 1, far: 9 });
  if (kind === 'directional') Object.assign(camera, { left: -2, right: 2, top: 2, bottom: -2 });
  camera.layers.enable(UNSEEN);
  camera.updateProjectionMatrix();
  scene.add(light, new AmbientLight(0xffffff, 1));
  return light;
}

/** A square that faces the light and lies between it and the origin; only shadow maps show it. */
function addSquare({ scene }: Stage, { position }: DirectionalLight | SpotLight, half: number): Mesh {
  const square = new Mesh(new PlaneGeometry(2 * half, 2 * half), new MeshLambertMaterial());
  square.position.copy(position).multiplyScalar(0.5);
  square.lookAt(position);
  square.castShadow = true;
  square.material.shadowSide = 2;
  square.layers.set(UNSEEN);
  scene.add(square);
  return square;
}

function receivingCloud(): SplatCloudObject {
  const cloud = new SplatCloudObject(splatData(...manySplats(600)));
  cloud.receiveShadow = true;
  return cloud;
}

/** A floor at z = −1 with the shadows of a mesh and of a cloud that only shadow maps show. */
async function floorStage() {
  const stage = await newStage(EXACT);
  const light = addLight(stage, 'directional');
  const floor = new Mesh(new PlaneGeometry(9, 9), new MeshLambertMaterial());
  floor.position.z = -1;
  floor.receiveShadow = true;
  const square = addSquare(stage, light, 0.2);
  const cloud = new SplatCloudObject(splatData(...manySplats(600)));
  cloud.castShadow = true;
  cloud.layers.set(UNSEEN);
  cloud.instances = new SplatInstances(1);
  cloud.effects = [revealed(9)];
  stage.scene.add(floor, cloud);
  return { stage, light, square, cloud };
}

const revealed = (radius: number) => reveal({ from: [0, 0, 0], radius });

type FloorStage = Awaited<ReturnType<typeof floorStage>>;

/** Changes of a floor's shadows, by name. */
const SHADOW_CHANGES = {
  place: ({ cloud }) => cloud.position.set(0.2, 0, 0),
  opacity: ({ cloud }) => Object.assign(cloud, { opacity: 0.4 }),
  effect: ({ cloud }) => Object.assign(cloud, { effects: [revealed(0.8)] }),
  instance: ({ cloud }) => cloud.instances!.setMatrixAt(0, new Matrix4().makeScale(0.7, 0.7, 1)),
  accuracy: ({ cloud }) => Object.assign(cloud, { accuracy: { preset: 'high', alphaCutoff: 0.1 } }),
  edit: ({ cloud }) => editsOf(cloud.data!).set({ first: 0, count: 400 }, { opacities: [0] }),
  data: ({ cloud }) => Object.assign(cloud, { data: splatData(...manySplats(300)) }),
  'another cloud': ({ cloud, stage }) => {
    const other = cloud.clone();
    other.rotation.z = 0.7;
    stage.scene.add(other);
  },
  light: ({ light }) => light.position.set(-1, 2, 4),
  'light’s far plane': ({ light }) => {
    light.shadow.camera.far = 4.5;
    light.shadow.camera.updateProjectionMatrix();
  },
  mesh: ({ square }) => square.position.setX(square.position.x + 0.4),
} satisfies Readonly<Record<string, (floor: FloorStage) => void>>;

export type ShadowChange = keyof typeof SHADOW_CHANGES;

/** Splats in the shadow of a mesh that only shadow maps show. */
async function receiverStage() {
  const stage = await newStage(EXACT);
  const light = addLight(stage, 'directional');
  const square = addSquare(stage, light, 0.313);
  const cloud = receivingCloud();
  stage.scene.add(cloud);
  return { stage, light, square, cloud };
}

/** Scenes on demand: how they are made and drawn, and what moves in them. */
const DEMAND_SCENES = {
  'splats cast': {
    make: floorStage,
    draw: ({ stage }: FloorStage) => shot(stage),
    move: SHADOW_CHANGES.place,
  },
  'splats receive': {
    make: receiverStage,
    draw: ({ stage }: FloorStage) => shotWith(stage, { shadows: true }),
    move: SHADOW_CHANGES.mesh,
  },
};

/** Draws a frame of the page for each request, of the application or of `cloud`. */
function drawOnDemand({ renderer, scene, camera }: Stage, cloud: SplatCloudObject) {
  const drawn = { frames: 0, image: null as Pixels | null };
  let isRequested = false;
  const request = () => {
    if (isRequested) return;
    isRequested = true;
    requestAnimationFrame(async () => {
      isRequested = false;
      renderer.render(scene, camera);
      const frame = ++drawn.frames;
      const image = await canvasPixels(renderer);
      if (frame === drawn.frames) drawn.image = image;
    });
  };
  cloud.addEventListener('needsframe', request);
  /** Waits until the last image is `expected`; returns it. */
  const shows = async (expected: Pixels) => {
    await until(() => drawn.image !== null && isSame(drawn.image, expected));
    return drawn.image;
  };
  return { drawn, request, shows };
}

/** Renders until the canvas shows `expected`, for as long as tests wait; returns the last image. */
async function shotLike(stage: Stage, expected: Pixels): Promise<Pixels> {
  const endMs = performance.now() + PATIENCE_MS;
  for (;;) {
    const image = await meshShot(stage);
    if (isSame(image, expected) || performance.now() > endMs) return image;
  }
}

function isSame({ data }: Pixels, other: Pixels): boolean {
  return data.every((value, i) => value === other.data[i]);
}

export const shadowCases = {
  /**
   * Images of a canvas that draws only requested frames, and as they ought to be: after a request, and
   * after something has moved and another request; and the number of frames after the latter. Splats
   * have no data before the first frame.
   */
  shadowOnDemand: async (kind: keyof typeof DEMAND_SCENES, autoUpdate: boolean) => {
    const { make, draw, move } = DEMAND_SCENES[kind];
    const fresh = await make();
    const expected = [await draw(fresh)];
    const moved = await make();
    move(moved);
    expected.push(await draw(moved));
    const scene = await make();
    const { stage, cloud, light } = scene;
    const { data } = cloud;
    cloud.data = null;
    light.shadow.autoUpdate = autoUpdate;
    const { drawn, request, shows } = drawOnDemand(stage, cloud);
    request();
    await until(() => drawn.image !== null);
    cloud.data = data;
    const images = [await shows(expected[0])];
    const { frames } = drawn;
    move(scene);
    light.shadow.needsUpdate = true;
    request();
    images.push(await shows(expected[1]));
    return { expected, images, framesAfterMove: drawn.frames - frames };
  },

  /**
   * A still light over still splats: images before and after a change, the image of a scene that was
   * never different, and how often splats were drawn for the change, and for frames without one.
   */
  stillShadow: async (changed: ShadowChange) => {
    const change: (floor: FloorStage) => void = SHADOW_CHANGES[changed];
    const fresh = await floorStage();
    change(fresh);
    const expected = await shot(fresh.stage);
    const floor = await floorStage();
    const { framesDrawn } = splatEngineOf(floor.stage.renderer).counters();
    const drawn = () => splatEngineOf(floor.stage.renderer).counters().framesDrawn - framesDrawn;
    const before = await shot(floor.stage);
    const draws = [drawn()];
    const still = [await meshShot(floor.stage), await meshShot(floor.stage)];
    draws.push(drawn());
    change(floor);
    const after = await shotLike(floor.stage, expected);
    draws.push(drawn());
    still.push(await meshShot(floor.stage));
    draws.push(drawn());
    return { expected, before, after, still, draws };
  },

  /** A white floor at z = −1 that only the shadow of an unseen cloud falls on. */
  splatShadow: async (kind: LightKind, parameters: RendererParameters = EXACT) => {
    const stage = await newStage(parameters);
    const light = addLight(stage, kind);
    const floor = new Mesh(new PlaneGeometry(9, 9), new MeshLambertMaterial());
    floor.position.z = -1;
    floor.receiveShadow = true;
    const cloud = new SplatCloudObject(splatData(...manySplats(600)));
    cloud.scale.set(1, 0.8, 1);
    cloud.rotation.z = 0.4;
    cloud.castShadow = true;
    cloud.layers.set(UNSEEN);
    stage.scene.add(floor, cloud);
    const shadowed = await shot(stage);
    cloud.castShadow = false;
    const { shadow, color, intensity } = light;
    return {
      modelMatrix: [...cloud.matrixWorld.elements],
      shadowed,
      lit: await meshShot(stage),
      mapPx: MAP_PX,
      light: numbersOf(shadow.camera),
      camera: numbersOf(stage.camera),
      irradiance: color.toArray().map((value) => intensity * value),
    };
  },

  /** Splats in the shadow of an unseen square, before and after the square has moved to the side. */
  meshShadow: async (kind: LightKind, parameters: RendererParameters = EXACT) => {
    const stage = await newStage(parameters);
    const light = addLight(stage, kind);
    const square = addSquare(stage, light, 0.313);
    const cloud = receivingCloud();
    stage.scene.add(cloud);
    const images: Pixels[] = [await shotWith(stage, { shadows: true })];
    const center = [square.position.toArray()];
    square.position.x += 0.3;
    images.push(await shot(stage));
    center.push(square.position.toArray());
    cloud.receiveShadow = false;
    // The list of effects has none of a caller's that is off.
    await until(() => {
      stage.renderer.render(stage.scene, stage.camera);
      return !areOn(stage.renderer, { shadows: true });
    });
    const without = await shot(stage);
    const { shadow, color, intensity } = light;
    return {
      images,
      without,
      center,
      half: 0.313,
      mapPx: MAP_PX,
      light: numbersOf(shadow.camera),
      camera: numbersOf(stage.camera),
      irradiance: color.toArray().map((value) => intensity * value),
      cone: light instanceof SpotLight ? { angle: light.angle, penumbra: light.penumbra } : null,
    };
  },

  /** Whether splats that cast or receive no shadows leave anything in scene, ledger and memory. */
  noShadows: async () => {
    const stage = await newStage();
    addLight(stage, 'directional');
    stage.scene.add(splatCloud({}));
    const engine = splatEngineOf(stage.renderer);
    const views = () => engine.memory().frames.views.length;
    const before = views();
    await shot(stage);
    const layer = stage.scene.children.find(({ name }) => name === 'splats')!;
    return {
      parts: layer.children.length,
      effects: engine.effects().filter(({ name }) => name === 'shadows'),
      views: views() - before,
    };
  },
};
