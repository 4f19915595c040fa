import { type AccuracyChoice, encodePly, packCloud } from '@websplatter/core';
import { antialias, brightness, tint, volumes } from '@websplatter/core/effects';
import { writeSplats } from '@websplatter/core/write';
import {
  adoptRenderer,
  encodedColor,
  onDeviceLost,
  onStageTimings,
  type SplatCloudObject,
  SplatCloudObject as SplatCloudObjectClass,
  SplatData,
  SplatInstances,
  SplatLoader,
  splatEngineOf,
  splatLimits,
  volumeOf,
} from '@websplatter/three';
import { SplatGltfPlugin } from '@websplatter/three/gltf';
import { editsOf, makeGpuSplats, makeMorphData, makeSplatData } from '@websplatter/three/own-data';
import { SplatSequence } from '@websplatter/three/sequence';
import {
  splatColor,
  splatIndex,
  splatNode,
  splatPosition,
  splatRotation,
  turned,
} from '@websplatter/three/tsl';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { dof } from 'three/addons/tsl/display/DepthOfFieldNode.js';
import {
  emissive,
  Fn,
  float,
  fog as fogNode,
  instancedArray,
  instanceIndex,
  mrt,
  output,
  pass,
  rangeFogFactor,
  reflector,
  select,
  texture,
  time,
  uniform,
  vec2,
  vec3,
  vec4,
} from 'three/tsl';
import {
  ACESFilmicToneMapping,
  BoxGeometry,
  BundleGroup,
  ClippingGroup,
  Color,
  CubeCamera,
  CubeRenderTarget,
  DirectionalLight,
  EqualStencilFunc,
  FloatType,
  Fog,
  FogExp2,
  Group,
  HalfFloatType,
  KeepStencilOp,
  LinearSRGBColorSpace,
  type Material,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshBasicNodeMaterial,
  MeshStandardMaterial,
  Object3D,
  OrthographicCamera,
  PerspectiveCamera,
  Plane,
  PlaneGeometry,
  Raycaster,
  REVISION,
  RenderPipeline,
  RenderTarget,
  ReplaceStencilOp,
  Sphere,
  SRGBColorSpace,
  Texture,
  Vector2,
  Vector3,
} from 'three/webgpu';
import { testScene } from '../test-scene.ts';
import { arrayCases } from './array-cases.ts';
import { lightCases } from './light-cases.ts';
import { postCases } from './post-cases.ts';
import { shadowCases } from './shadow-cases.ts';
import { checkeredSplats, manySplats, splatCloud, splatData, splatSet } from './splats.ts';
import {
  areOn,
  drawn,
  foreignStage,
  makeRenderer,
  meshShot,
  newScene,
  newStage,
  nextFrame,
  nextNeededFrame,
  type Pixels,
  type RendererParameters,
  SIZE_PX,
  type Stage,
  shot,
  shotOf,
  shotWith,
  targetPixels,
  targetShot,
  until,
} from './stage.ts';

/** For images that are compared: their rasteriser must not follow from times. */
const BY_TILES = { accuracy: { rasterizer: 'tiles' } } as const;

/** The object of `keepShown`. */
let kept: SplatCloudObject | null = null;

/** A large square across the line of sight. */
function wall(color: number, z: number, options: Partial<Material> = {}): Mesh {
  const mesh = new Mesh(new PlaneGeometry(20, 20), new MeshBasicMaterial({ color }));
  Object.assign(mesh.material, options);
  mesh.position.z = z;
  return mesh;
}

/** Lets the left half of the image free, at any distance. */
function rightHalf(mesh: Mesh): Mesh {
  mesh.position.x = 10;
  return mesh;
}

/** A square image of one colour. */
function plainImage(color: string, sizePx: number): HTMLCanvasElement {
  const canvas = Object.assign(document.createElement('canvas'), { width: sizePx, height: sizePx });
  const context = canvas.getContext('2d')!;
  context.fillStyle = color;
  context.fillRect(0, 0, sizePx, sizePx);
  return canvas;
}

function errorsOf(cloud: SplatCloudObject): string[] {
  const errors: string[] = [];
  cloud.onError = (error) => errors.push(`${error.name}: ${error.message}`);
  return errors;
}

/** A lit box over a lit floor that it throws a shadow on. */
function litScene({ scene, camera, renderer }: Stage): void {
  renderer.shadowMap.enabled = true;
  const material = new MeshStandardMaterial({ color: 0xcc8844 });
  const floor = new Mesh(new PlaneGeometry(10, 10), material);
  floor.position.z = -1;
  const box = new Mesh(new BoxGeometry(), material);
  box.position.z = -0.5;
  box.rotation.set(0.5, 0.5, 0);
  const sun = new DirectionalLight(0xffffff, 2);
  sun.position.set(2, 3, 4);
  for (const mesh of [floor, box]) {
    mesh.castShadow = true;
    mesh.receiveShadow = true;
  }
  sun.castShadow = true;
  sun.shadow.mapSize.set(256, 256);
  scene.add(floor, box, sun);
  camera.position.z = 3;
}

function lookAtTestScene(camera: PerspectiveCamera): void {
  camera.position.set(1, 0.5, 6);
  camera.lookAt(0.5, 0, 0);
}

/** The camera of the tests' references. */
function cameraOf({ matrixWorldInverse, projectionMatrix, near, far }: PerspectiveCamera) {
  const [viewMatrix, projection] = [matrixWorldInverse.elements, projectionMatrix.elements];
  return { camera: { viewMatrix: [...viewMatrix], projectionMatrix: [...projection], near, far } };
}

/** A binary glTF with other nodes, of which the first is its scene. */
function withNodes(file: Uint8Array<ArrayBuffer>, nodes: readonly object[]): Uint8Array<ArrayBuffer> {
  const jsonEnd = 20 + new DataView(file.buffer).getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(file.subarray(20, jsonEnd)));
  const text = JSON.stringify({ ...json, nodes, scenes: [{ nodes: [0] }], scene: 0 });
  const padded = new TextEncoder().encode(text.padEnd(4 * Math.ceil(text.length / 4)));
  const result = new Uint8Array(20 + padded.length + file.length - jsonEnd);
  result.set(file.subarray(0, 20));
  result.set(padded, 20);
  result.set(file.subarray(jsonEnd), 20 + padded.length);
  const header = new DataView(result.buffer);
  header.setUint32(8, result.length, true);
  header.setUint32(12, padded.length, true);
  return result;
}

/** Cases that tests run by name; the tests compare their results. */
export const cases = {
  ...arrayCases,
  ...lightCases,
  ...postCases,
  ...shadowCases,

  revision: async () => REVISION,

  /** A white splat of half opacity over `background`. */
  over: async (background: number, parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    stage.scene.background = new Color(background);
    stage.scene.add(splatCloud({}));
    return shot(stage);
  },

  /** The same over lit and shadowed meshes; both images. */
  overLitMeshes: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    litScene(stage);
    const without = await meshShot(stage);
    const cloud = splatCloud({ position: [0, 0, 1] });
    cloud.castShadow = true;
    stage.scene.add(cloud);
    return { without, with: await shot(stage) };
  },

  /** A splat between two walls: red on the right in front, blue all over behind. */
  betweenMeshes: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), wall(0x0000ff, -0.5), splatCloud({}));
    return shot(stage);
  },

  /** Splats, and a wall before their right half, in a colour that depends on the same time and gain. */
  nodes: async () => {
    const stage = await newStage();
    const gain = uniform(0.5);
    const shade = vec3(time.mul(1000).fract().mul(0.1).add(gain), 0.25, 0.5);
    const cloud = splatCloud({});
    cloud.effects = [splatNode({ color: splatColor.mul(0).add(shade) })];
    const mesh = rightHalf(wall(0xffffff, 0.5));
    mesh.material = Object.assign(new MeshBasicNodeMaterial(), { colorNode: shade });
    stage.scene.add(mesh, cloud);
    const images = [];
    for (const value of [0.25, 0.75]) {
      gain.value = value;
      images.push(await shot(stage));
    }
    return images;
  },

  /**
   * A lying bar at the left, black while its image loads, and then red by it; moved to the right by a
   * compute pass; green by another image; upright by a turn.
   */
  nodeResources: async () => {
    const stage = await newStage();
    const { renderer, scene } = stage;
    // As TextureLoader returns it.
    const map = new Texture();
    map.colorSpace = SRGBColorSpace;
    const offsets = instancedArray(1, 'vec3');
    const [shift, angle] = [uniform(0), uniform(0)];
    const moving = Fn(() => {
      offsets.element(0).assign(vec3(shift, 0, 0));
    })().compute(1);
    const cloud = splatCloud({ position: [-1, 0, 0], scale: [0.4, 0.04, 0.01], opacity: 0.99 });
    cloud.effects = [
      splatNode({
        position: splatPosition.add(offsets.element(splatIndex)),
        rotation: turned(splatRotation, vec3(0, 0, 1), angle),
        color: texture(map, vec2(0.25, 0.5)).rgb,
      }),
    ];
    scene.add(cloud);
    renderer.compute(moving);
    const images = [await shot(stage)];
    map.image = plainImage('#f00', 2);
    map.needsUpdate = true;
    images.push(await shot(stage));
    shift.value = 2;
    renderer.compute(moving);
    images.push(await shot(stage));
    map.dispose();
    map.image = plainImage('#0f0', 8);
    map.needsUpdate = true;
    images.push(await shot(stage));
    angle.value = Math.PI / 2;
    images.push(await shot(stage));
    return images;
  },

  /** The same splats by three's loader of glTF, and as data. */
  gltf: async () => {
    const stage = await newStage();
    const set = splatSet([{}]);
    const { buffer } = await writeSplats(set, 'gltf');
    const loader = new GLTFLoader().register((parser) => new SplatGltfPlugin(parser));
    const { scene } = await loader.parseAsync(buffer as ArrayBuffer, '');
    stage.scene.add(scene);
    const loaded = await shot(stage);
    stage.scene.remove(scene);
    stage.scene.add(new SplatCloudObjectClass(makeSplatData(set)));
    return { loaded, expected: await shot(stage) };
  },

  /** A glTF whose nested nodes scale unevenly and shear, by three's loader and by `SplatLoader`. */
  gltfUneven: async () => {
    const stage = await newStage();
    const splats = splatSet(manySplats(400));
    const coefficients = Float32Array.from({ length: 9 * splats.count }, (_, i) => 0.5 * Math.sin(7 * i));
    const harmonics = { degree: 1, coefficients } as const;
    const file = withNodes(await writeSplats({ ...splats, harmonics }, 'gltf'), [
      { children: [1], rotation: [0, 0.6, 0, 0.8], scale: [1.5, 0.6, 1.1] },
      { mesh: 0, rotation: [0.48, 0, 0.64, 0.6], scale: [0.8, 1.2, -0.7] },
    ]);
    const loader = new GLTFLoader().register((parser) => new SplatGltfPlugin(parser));
    const { scene } = await loader.parseAsync(file.slice().buffer, '');
    stage.scene.add(scene);
    const loaded = await shot(stage);
    stage.scene.remove(scene);
    stage.scene.add(new SplatCloudObjectClass(await new SplatLoader().loadAsync(new Blob([file]))));
    return { loaded, expected: await shot(stage) };
  },

  /** Plays files of one colour each in a pool of two; counts clouds at every look. */
  sequence: async (colors: readonly (readonly [number, number, number])[], frames: number) => {
    const stage = await newStage();
    const { renderer, scene } = stage;
    const fileOf = (color: (typeof colors)[number], i: number) =>
      new File([encodePly(splatSet([{ color }])) as Uint8Array<ArrayBuffer>], `frame ${i}.ply`);
    const makeLoader = () => new SplatLoader().detectSupport(renderer);
    const options = { framesPerS: 20, maxHeldFrames: 2 };
    const sequence = new SplatSequence(colors.map(fileOf), makeLoader, options);
    const heldNow = () => {
      const { clouds } = splatEngineOf(renderer).memory().scene;
      return clouds.filter(({ name }) => name.startsWith('frame ')).length;
    };
    const cloud = new SplatCloudObjectClass();
    scene.add(cloud);
    const shown: { frame: number; image: Pixels }[] = [];
    let mostHeld = 0;
    while (shown.length < frames) {
      mostHeld = Math.max(mostHeld, heldNow());
      if (sequence.data === cloud.data) await nextFrame();
      else {
        cloud.data = sequence.data;
        shown.push({ frame: sequence.frame, image: await shot(stage) });
      }
    }
    sequence.dispose();
    cloud.dispose();
    await until(() => heldNow() === 0);
    return { shown, mostHeld, left: heldNow() };
  },

  betweenMeshesOrthographic: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const camera = new OrthographicCamera(-1, 1, 1, -1, 0.1, 100);
    camera.position.z = 3;
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), wall(0x0000ff, -0.5), splatCloud({}));
    return shotOf(stage, () => stage.renderer.render(stage.scene, camera));
  },

  /** Tone mapping of the splat's image, and of a background of the colour `linear`. */
  toneMapped: async (background: number, linear: number) => {
    const stage = await newStage();
    stage.renderer.toneMapping = ACESFilmicToneMapping;
    stage.scene.background = new Color(linear, linear, linear);
    const expected = await meshShot(stage);
    stage.scene.background = new Color(background);
    stage.scene.add(splatCloud({}));
    return { expected, actual: await shot(stage) };
  },

  /**
   * The test scene in a renderer that three alone has made, between a blue wall behind and a red one
   * in front of the right half. The cloud and, if `isLoaded`, a loader ask for the engine.
   */
  foreignRenderer: async (parameters: { readonly antialias?: boolean }, isLoaded: boolean) => {
    const stage = await foreignStage(parameters);
    const { renderer, scene, camera } = stage;
    const blob = new Blob([encodePly(testScene()) as BlobPart]);
    const loader = isLoaded ? new SplatLoader().detectSupport(renderer) : new SplatLoader();
    const cloud = new SplatCloudObjectClass(await loader.loadAsync(blob));
    const errors = errorsOf(cloud);
    const [behind, inFront] = [wall(0x204060, -50), rightHalf(wall(0xff0000, -1))];
    behind.scale.setScalar(10);
    camera.add(behind, inFront);
    scene.add(camera, cloud);
    lookAtTestScene(camera);
    const lost: string[] = [];
    onDeviceLost(renderer, ({ reason }) => lost.push(reason));
    if (!isLoaded) {
      const needed = nextNeededFrame(scene);
      renderer.render(scene, camera);
      await needed;
    }
    const image = await shot(stage);
    const engine = splatEngineOf(renderer);
    const { device } = renderer.backend as unknown as { readonly device: GPUDevice };
    const isOnItsDevice = engine.device === device;
    await renderer.dispose();
    await engine.lost;
    const { totalBytes: bytesLeft } = engine.memory();
    return { image, errors, lost, isOnItsDevice, bytesLeft, ...cameraOf(camera) };
  },

  /** Errors of more splats in view than a device by default has room for, with its limits or the GPU's. */
  foreignLimits: async (hasLimits: boolean) => {
    const { renderer, scene, camera } = await foreignStage(
      hasLimits ? { requiredLimits: await splatLimits() } : {},
    );
    // Records have room for each instance of each splat: 4.3 million.
    const count = 100_000;
    const positions = new Float32Array(3 * count);
    const scales = new Float32Array(3 * count).fill(1e-5);
    const colors = new Float32Array(3 * count);
    // Too faint to be drawn: SwiftShader need not sort them for a minute.
    const opacities = new Float32Array(count).fill(0.002);
    const cloud = new SplatCloudObjectClass(makeSplatData({ positions, scales, colors, opacities }));
    cloud.instances = new SplatInstances(43);
    const errors = errorsOf(cloud);
    scene.add(cloud);
    const engine = splatEngineOf(await adoptRenderer(renderer));
    await until(() => {
      renderer.render(scene, camera);
      return errors.length > 0 || engine.counters().framesDrawn > 0;
    });
    await renderer.dispose();
    return { errors, framesDrawn: engine.counters().framesDrawn };
  },

  /** Errors of a cloud in a renderer that draws with WebGL 2, with a mesh that it does draw. */
  webGlBackend: async () => {
    const stage = await foreignStage({ forceWebGL: true });
    const { renderer, scene, camera } = stage;
    const cloud = splatCloud({});
    const errors = errorsOf(cloud);
    scene.add(cloud, wall(0x0000ff, -0.5));
    for (let frame = 0; frame < 2; frame++) renderer.render(scene, camera);
    const { calls } = renderer.info.render as unknown as { readonly calls: number };
    await renderer.dispose();
    return { errors, calls };
  },

  transparentCanvas: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    stage.scene.background = null;
    stage.renderer.setClearColor(0x000000, 0);
    stage.scene.add(splatCloud({ color: [1, 0.5, 0] }));
    return shot(stage);
  },

  /** Straight onto the canvas: three needs no output pass if it neither tone-maps nor encodes. */
  withoutOutputPass: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    stage.renderer.outputColorSpace = LinearSRGBColorSpace;
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    return shot(stage);
  },

  renderTarget: async (options: { samples?: number; isFloat?: boolean; depthBuffer?: boolean } = {}) => {
    const stage = await newStage();
    const { samples = 0, isFloat = false, depthBuffer = true } = options;
    const type = isFloat ? FloatType : HalfFloatType;
    const target = new RenderTarget(SIZE_PX, SIZE_PX, { type, samples, depthBuffer });
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    return targetShot(stage, target);
  },

  /** A rectangle of a render target. */
  renderTargetViewport: async () => {
    const stage = await newStage();
    const target = new RenderTarget(SIZE_PX, SIZE_PX, { type: HalfFloatType });
    target.viewport.set(16, 8, 32, 32);
    target.scissor.set(16, 8, 32, 32);
    target.scissorTest = true;
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    return targetShot(stage, target);
  },

  postProcessing: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const { renderer, scene, camera } = stage;
    scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    const scenePass = pass(scene, camera);
    scenePass.setMRT(mrt({ output, emissive }));
    const image = scenePass.getTextureNode('output');
    // 0.185 draws only outputs that somebody has asked for.
    scenePass.getTextureNode('emissive');
    const pipeline = new RenderPipeline(renderer, image);
    return shotOf(stage, () => pipeline.render());
  },

  /**
   * Checkered splats on the left and stripes of a mesh on the right, equally far: as they are, in
   * three's depth of field with the focus on them and before them, and view depths as red, in parts
   * of `depthRange`.
   */
  depthOfField: async (depthRange: number) => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const cloud = splatCloud(...checkeredSplats());
    cloud.depthWrite = true;
    scene.add(cloud);
    for (let stripe = 0; stripe < 8; stripe++) {
      const mesh = new Mesh(new PlaneGeometry(0.1, 4), new MeshBasicMaterial());
      mesh.position.x = 0.15 + 0.2 * stripe;
      scene.add(mesh);
    }
    const wide = rightHalf(wall(0x000000, -0.01));
    scene.add(wide);
    const scenePass = pass(scene, camera);
    const [image, viewZ] = [scenePass.getTextureNode(), scenePass.getViewZNode()];
    const focus = uniform(3);
    const pipelines = [image, dof(image, viewZ, focus, 1, 2), vec4(viewZ.negate().div(depthRange), 0, 0, 1)];
    const [plain, blurred, deep] = pipelines.map((node) => new RenderPipeline(renderer, node));
    deep.outputColorTransform = false;
    const shown = async (pipeline: RenderPipeline) => {
      // three draws a pass once per frame of the page, however often it is asked to.
      await nextFrame();
      return shotOf(stage, () => pipeline.render());
    };
    // Compiles the splats' shaders: another attempt might be in the frame of the first.
    await shot(stage);
    const images = { plain: await shown(plain), focused: await shown(blurred), depths: await shown(deep) };
    focus.value = 1;
    return { ...images, unfocused: await shown(blurred), ...cameraOf(camera) };
  },

  /**
   * Own splats as they are edited, red on the left and one hidden on the right; then in another
   * renderer.
   */
  ownData: async () => {
    const stage = await newStage();
    const data = makeSplatData({
      positions: [-0.9, 0, 0, 0.9, 0, 0],
      scales: [0.3, 0.6, 0.1, 0.3, 0.6, 0.1],
      colors: [1, 0, 0, 0, 1, 0],
    });
    const edits = editsOf(data);
    edits.set([1], { visible: false });
    const cloud = new SplatCloudObjectClass(data);
    stage.scene.add(cloud);
    const made = await shot(stage);
    await data.prepareRays();
    const ray = new Raycaster(new Vector3(0.9, 0, 3), new Vector3(0, 0, -1));
    const hitsAt = (x: number) => {
      ray.ray.origin.x = x;
      return ray.intersectObject(cloud).length;
    };
    const hits = [hitsAt(0.9)];
    const needed = new Promise((resolve) => cloud.addEventListener('needsframe', resolve));
    edits.set([1], { visible: true });
    edits.set({ first: 0, count: 2 }, { positions: [0.9, 0, 0, -0.9, 0, 0], opacities: [0.5] });
    await needed;
    const edited = await shot(stage);
    await data.prepareRays();
    hits.push(hitsAt(0.9));
    const engine = splatEngineOf(stage.renderer);
    const before = engine.counters().uploadedBytes;
    edits.set([0], { colors: [0, 0, 1] });
    const recoloured = await shot(stage);
    const uploadedBytes = engine.counters().uploadedBytes - before;
    const other = await newStage({ antialias: true });
    other.scene.add(new SplatCloudObjectClass(data));
    return { made, edited, recoloured, elsewhere: await shot(other), hits, uploadedBytes };
  },

  /** Two splats that exchange their places; begins at the end, before anything was drawn. */
  morph: async () => {
    const stage = await newStage();
    const from = {
      positions: [-0.9, 0, 0, 0.9, 0, 0],
      scales: [0.3, 0.6, 0.1, 0.3, 0.6, 0.1],
      colors: [1, 0, 0, 0, 1, 0],
    };
    const data = makeMorphData(from, { ...from, positions: [0.9, 0, 0, -0.9, 0, 0] });
    data.amount = 1;
    const cloud = new SplatCloudObjectClass(data);
    stage.scene.add(cloud);
    const end = await shot(stage);
    const engine = splatEngineOf(stage.renderer);
    const before = engine.counters().uploadedBytes;
    const needed = new Promise((resolve) => cloud.addEventListener('needsframe', resolve));
    data.amount = 0;
    await needed;
    const start = await shot(stage);
    const uploadedBytes = engine.counters().uploadedBytes - before;
    const other = await newStage({ antialias: true });
    other.scene.add(new SplatCloudObjectClass(data));
    data.amount = 1;
    return { end, start, elsewhere: await shot(other), uploadedBytes };
  },

  /** Two splats that TSL places by a uniform, with their values for others left to it as well. */
  gpuSplats: async () => {
    const stage = await newStage();
    const { renderer } = stage;
    const columns = [0, 0, 0].map(() => instancedArray(2, 'vec3'));
    const [positions, scales, colors] = columns;
    const opacities = instancedArray(2, 'float');
    const side = uniform(1);
    const simulation = Fn(() => {
      const isFirst = instanceIndex.equal(0);
      positions.element(instanceIndex).assign(vec3(select(isFirst, side.mul(-0.9), side.mul(0.9)), 0, 0));
      scales.element(instanceIndex).assign(vec3(0.3, 0.6, 0.1));
      colors.element(instanceIndex).assign(vec3(select(isFirst, 1, 0), select(isFirst, 0, 1), 0));
      opacities.element(instanceIndex).assign(1);
    })().compute(2);
    renderer.compute(simulation);
    const bounds = { min: [-1, 0, 0], max: [1, 0, 0] } as const;
    const data = makeGpuSplats(renderer, { positions, scales, colors, opacities, bounds });
    const cloud = new SplatCloudObjectClass(data);
    stage.scene.add(cloud);
    const start = await shot(stage);
    const engine = splatEngineOf(renderer);
    const before = engine.counters().uploadedBytes;
    const needed = new Promise((resolve) => cloud.addEventListener('needsframe', resolve));
    side.value = -1;
    renderer.compute(simulation);
    data.changed();
    await needed;
    const end = await shot(stage);
    const uploadedBytes = engine.counters().uploadedBytes - before;
    side.value = 2;
    renderer.compute(simulation);
    data.changed();
    return { start, end, uploadedBytes, outside: await shot(stage), faults: await data.countFaults() };
  },

  twoRenderers: async () => {
    const data = splatData({});
    const stages = [await newStage(), await newStage({ antialias: true })];
    const clouds = stages.map(() => new SplatCloudObjectClass(data));
    stages.forEach(({ scene }, i) => {
      scene.background = new Color(i === 0 ? 0x000000 : 0xffffff);
      scene.add(clouds[i]);
    });
    const images: Pixels[] = [];
    for (const stage of stages) images.push(await shot(stage));
    return images;
  },

  /** The same scene, on the left with a red wall behind the splats, on the right without splats. */
  viewports: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const { renderer, scene, camera } = stage;
    const cloud = splatCloud({});
    cloud.layers.set(1);
    camera.layers.enable(1);
    const other = new PerspectiveCamera(60, 1, 0.1, 100);
    other.position.z = 3;
    const narrow = new PerspectiveCamera(30, 1, 0.1, 100);
    narrow.position.z = 3;
    narrow.layers.enable(1);
    scene.add(rightHalf(wall(0xff0000, 0.5)), cloud);
    renderer.setScissorTest(true);
    const half = SIZE_PX / 2;
    return shotOf(
      stage,
      () => {
        for (const [x, y, view] of [
          [0, 0, camera],
          [half, 0, other],
          [half, half, narrow],
        ] as const) {
          renderer.setViewport(x, y, half, half);
          renderer.setScissor(x, y, half, half);
          renderer.render(scene, view);
        }
      },
      2,
    );
  },

  /**
   * The walls and the splat between them, with a near plane that leans to the left, as in mirrors.
   *
   * @param distance of that plane along the line of sight.
   */
  obliqueNearPlane: async (distance: number, parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const { renderer, scene, camera } = stage;
    scene.add(rightHalf(wall(0xff0000, 0.5)), wall(0x0000ff, -0.5), splatCloud({}));
    // three makes the matrix for its kind of clip space at the first rendering with the camera.
    renderer.render(scene, camera);
    const [normalX, normalZ, scale] = [0.5, -0.866, 0.8];
    const row = [normalX, 0, normalZ, normalZ * distance];
    row.forEach((value, column) => {
      camera.projectionMatrix.elements[4 * column + 2] = scale * value;
    });
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    return shot(stage);
  },

  /** A slanted mirror on the right, a magenta splat behind it; a yellow splat before a blue box. */
  mirror: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const { scene } = stage;
    const reflection = reflector();
    const material = new MeshBasicNodeMaterial();
    material.colorNode = reflection;
    const mirror = new Mesh(new PlaneGeometry(2, 3), material);
    mirror.position.set(1, 0, 0);
    mirror.rotation.y = -0.6;
    reflection.target.position.copy(mirror.position);
    reflection.target.rotation.copy(mirror.rotation);
    const box = new Mesh(new BoxGeometry(0.6, 0.6, 0.6), new MeshBasicMaterial({ color: 0x0000ff }));
    box.position.set(-1, -0.5, 0.6);
    const cloud = splatCloud(
      { position: [-0.9, -0.3, 0], scale: [0.3, 0.3, 0.3], opacity: 0.99, color: [1, 1, 0] },
      { position: [1.2, 0.6, -1.2], scale: [0.3, 0.3, 0.3], opacity: 0.99, color: [1, 0, 1] },
    );
    scene.add(mirror, reflection.target, box, cloud);
    return shot(stage, 2);
  },

  /** Half-transparent walls in front and behind by their own place among transparent objects. */
  transparentMeshes: async (frontZ: number, backZ: number) => {
    const stage = await newStage();
    const half = { transparent: true, opacity: 0.5 };
    stage.scene.add(
      rightHalf(wall(0xff0000, frontZ, half)),
      wall(0x0000ff, backZ, half),
      splatCloud({ scale: [50, 50, 0.001] }),
    );
    return shot(stage);
  },

  /** An almost opaque splat, and behind it a wall that is drawn later. */
  depthWriteBack: async (depthWrite: boolean, parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const cloud = splatCloud({ opacity: 0.9 });
    cloud.depthWrite = depthWrite;
    const later = { transparent: true };
    const behind = wall(0x00ff00, -0.5, later);
    const front = rightHalf(wall(0xff0000, 0.5, later));
    behind.renderOrder = 1;
    front.renderOrder = 1;
    stage.scene.add(behind, front, cloud);
    return shot(stage);
  },

  resize: async () => {
    const stage = await newStage();
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    const before = await shot(stage);
    stage.renderer.setSize(96, 48, false);
    stage.camera.aspect = 2;
    stage.camera.updateProjectionMatrix();
    return { before, after: await shot(stage) };
  },

  compileAsync: async () => {
    const renderer = await makeRenderer({});
    renderer.setSize(SIZE_PX, SIZE_PX, false);
    const stage = { renderer, ...newScene() };
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    await renderer.compileAsync(stage.scene, stage.camera);
    const image = await shot(stage);
    await renderer.compileAsync(stage.scene, stage.camera);
    const again = await shot(stage);
    await renderer.dispose();
    return [image, again];
  },

  /** Red, green and red again from back to front, of two clouds. */
  interleavedClouds: async () => {
    const stage = await newStage();
    const red = splatCloud(
      { position: [0, 0, -1], color: [1, 0, 0] },
      { position: [0, 0, 1], color: [1, 0, 0] },
    );
    const green = splatCloud({ color: [0, 1, 0] });
    stage.scene.add(green, red);
    return shot(stage);
  },

  /**
   * Red before green, each nearly opaque, before a blue wall: in full, faded, and in full again. Says
   * whether each change left frames without splats.
   */
  fade: async () => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const cloud = splatCloud(
      { opacity: 0.9, color: [1, 0, 0] },
      { position: [0, 0, -1], opacity: 0.9, color: [0, 1, 0] },
    );
    scene.add(wall(0x0000ff, -2), cloud);
    const pixels = [await shotWith(stage, { fade: false })];
    const gaps: boolean[] = [];
    for (const fade of [0.3, 0.7, 1]) {
      cloud.fade = fade;
      const { framesDrawn } = splatEngineOf(renderer).counters();
      renderer.render(scene, camera);
      gaps.push(splatEngineOf(renderer).counters().framesDrawn === framesDrawn);
      pixels.push(await shotWith(stage, { fade: fade < 1 }));
    }
    return { pixels, gaps };
  },

  /** The test scene under a matrix, and the reference's data to draw it. */
  transformed: async (matrix: number[], parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const { camera, scene } = stage;
    const packed = packCloud(testScene(), { geometryPrecision: 'packed' });
    const cloud = new SplatCloudObjectClass(new SplatData(packed, 'test scene'));
    cloud.matrixAutoUpdate = false;
    cloud.matrix.fromArray(matrix);
    // A parent, too, that the world matrix has to be taken from.
    const parent = new Object3D();
    parent.position.set(-0.5, -1, 0);
    parent.add(cloud);
    scene.add(parent);
    lookAtTestScene(camera);
    const image = await shot(stage);
    return { image, ...cameraOf(camera), modelMatrix: [...cloud.matrixWorld.elements] };
  },

  /** Opacity, visibility and layers of objects and of their parents. */
  shownParts: async () => {
    const stage = await newStage();
    const cloud = splatCloud({});
    const parent = new Object3D();
    parent.add(cloud);
    // Something to be drawn in any case.
    const far = splatCloud({ scale: [0.01, 0.01, 0.01], position: [50, 0, 0] });
    stage.scene.add(parent, far);
    const shown = await shot(stage);
    cloud.opacity = 0.5;
    const faint = await shotWith(stage, { opacity: true });
    cloud.opacity = 0;
    const gone = await shot(stage);
    cloud.opacity = 1;
    parent.visible = false;
    const hidden = await shot(stage);
    parent.visible = true;
    cloud.layers.set(3);
    const otherLayer = await shot(stage);
    return { shown, faint, gone, hidden, otherLayer };
  },

  /** Red splats left and a red wall right, equally far, in fog; then the splats without fog. */
  fog: async (fog: { near: number; far: number; isNode?: boolean } | { density: number }) => {
    const stage = await newStage();
    const color = 0x8090b0;
    if ('density' in fog) stage.scene.fog = new FogExp2(color, fog.density);
    else if (!fog.isNode) stage.scene.fog = new Fog(color, fog.near, fog.far);
    else {
      const factor = rangeFogFactor(float(fog.near), uniform(fog.far));
      stage.scene.fogNode = fogNode(uniform(new Color(color)), factor);
    }
    const cloud = splatCloud({ color: [1, 0, 0], opacity: 0.99 }, { color: [1, 0, 0], opacity: 0.99 });
    stage.scene.add(rightHalf(wall(0xff0000, 0.001)), cloud);
    const fogged = await shotWith(stage, { fog: true });
    cloud.fog = false;
    const clear = await shotWith(stage, { fog: false });
    return { fogged, clear };
  },

  /** A white splat on the left and one on the right; and both tinted, the right one cut off. */
  effects: async () => {
    const stage = await newStage();
    const small = { scale: [0.3, 0.3, 0.3], opacity: 0.99 } as const;
    const cloud = splatCloud({ ...small, position: [-0.8, 0, 0] }, { ...small, position: [0.8, 0, 0] });
    stage.scene.add(cloud);
    const plain = await shot(stage);
    cloud.effects = [tint(encodedColor('#ff8000')), volumes([volumeOf(new Plane(new Vector3(-1, 0, 0), 0))])];
    const tintedAndClipped = await shotWith(stage, { tint: true, volumes: true });
    return { plain, tintedAndClipped };
  },

  /**
   * A valid cloud left, one with an invalid option right: errors and images by option, without and
   * with a frame before that shows it as it should be; and where it has overshot.
   */
  invalidOptions: async () => {
    const stage = await newStage();
    const small = (x: number) => splatCloud({ scale: [0.3, 0.3, 0.3], opacity: 0.99, position: [x, 0, 0] });
    const other = small(-0.8);
    const othersErrors = errorsOf(other);
    stage.scene.add(other);
    const firstShot = async (cloud: SplatCloudObject) => {
      let isDrawn = false;
      cloud.addEventListener('firstframe', () => {
        isDrawn = true;
      });
      stage.scene.add(cloud);
      for (;;) {
        const pixels = await shot(stage);
        if (isDrawn) return pixels;
      }
    };
    const errors: Record<string, string[]> = {};
    const images: Record<string, Pixels> = {};
    const lasting: Record<string, Pixels> = {};
    const invalid = {
      opacity: { opacity: Number.NaN },
      radius: { reveal: { from: 'camera', radius: Number.NaN } },
      accuracy: { accuracy: 'slow' },
      target: { accuracy: { maxFrameMs: -1 } },
      detail: { detail: { maxErrorPx: -1 } },
      shDegree: { shDegree: 7 },
      twice: { effects: [tint([1, 1, 0]), tint([1, 0, 0])] },
    };
    for (const [name, options] of Object.entries(invalid)) {
      const cloud = Object.assign(small(0.8), options) as SplatCloudObject;
      errors[name] = errorsOf(cloud);
      stage.scene.add(cloud);
      images[name] = await shot(stage);
      await until(() => errors[name].length > 0);
      cloud.removeFromParent();
      const valid = small(0.8);
      errorsOf(valid);
      await firstShot(valid);
      Object.assign(valid, options);
      lasting[name] = await shot(stage);
      valid.removeFromParent();
    }
    const overshot = Object.assign(small(0.8), { opacity: 1.0015 }) as SplatCloudObject;
    return { errors, othersErrors, images, lasting, overshot: await firstShot(overshot) };
  },

  /** Two splats, and two boxes, in a group that keeps the left side. */
  clippingGroup: async () => {
    const stage = await newStage();
    const group = new ClippingGroup();
    group.clippingPlanes = [new Plane(new Vector3(-1, 0, 0), 0)];
    stage.scene.add(group);
    const boxes = [-0.8, 0.8].map((x) => {
      const box = new Mesh(new BoxGeometry(0.6, 0.6, 0.6), new MeshBasicMaterial());
      box.position.x = x;
      return box;
    });
    group.add(...boxes);
    const meshes = await meshShot(stage);
    group.remove(...boxes);
    const small = { scale: [0.3, 0.3, 0.3], opacity: 0.99 } as const;
    group.add(splatCloud({ ...small, position: [-0.8, 0, 0] }, { ...small, position: [0.8, 0, 0] }));
    return { splats: await shot(stage), meshes };
  },

  /** The test scene in one image, and in four parts of it. */
  viewOffset: async () => {
    const stage = await newStage();
    const packed = packCloud(testScene(), { geometryPrecision: 'packed' });
    stage.scene.add(new SplatCloudObjectClass(new SplatData(packed, 'test scene')));
    // Wide, and close enough for splats that reach far beyond the middle of a part.
    stage.camera.fov = 100;
    stage.camera.position.set(0.5, 0, 3);
    stage.camera.updateProjectionMatrix();
    const whole = await shot(stage);
    const half = SIZE_PX / 2;
    stage.renderer.setSize(half, half, false);
    const parts: Pixels[] = [];
    for (const [x, y] of [
      [0, 0],
      [half, 0],
      [0, half],
      [half, half],
    ]) {
      stage.camera.setViewOffset(SIZE_PX, SIZE_PX, x, y, half, half);
      parts.push(await shot(stage));
    }
    return { whole, parts };
  },

  /**
   * A cloud; at once and in the end, as another with shaders of its own joins it, and as that
   * becomes yet another.
   */
  joining: async () => {
    const stage = await newStage();
    const small = (x: number) => splatData({ scale: [0.3, 0.3, 0.3], opacity: 0.99, position: [x, 0, 0] });
    const joining = new SplatCloudObjectClass(small(0.8));
    joining.effects = [tint([1, 0.5, 0]), brightness(1.5)];
    stage.scene.add(new SplatCloudObjectClass(small(-0.8)));
    const alone = await shot(stage);
    stage.scene.add(joining);
    const atOnce = await meshShot(stage);
    const both = await shotWith(stage, { brightness: true });
    joining.data = small(0);
    joining.effects = [antialias(), brightness(1.5)];
    const replacedAtOnce = await meshShot(stage);
    const replaced = await shotWith(stage, { antialias: true });
    return { alone, atOnce, both, replacedAtOnce, replaced };
  },

  /** How often a cloud asks for a frame until it is revealed, and images from before and after. */
  reveal: async (durationMs: number) => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const cloud = splatCloud({ scale: [2, 2, 0.01], opacity: 0.99 });
    scene.add(cloud);
    const shown = await shot(stage);
    // Compiling takes part of a reveal's time: of this one, that is nothing.
    cloud.reveal = { from: [0, 0, 0], durationMs: 1e9 };
    const hidden = await shotWith(stage, { reveal: true });
    cloud.reveal = { from: [0, 0, 0], durationMs };
    let frames = 0;
    const revealed = new Promise<void>((resolve) => {
      cloud.addEventListener('needsframe', () => {
        requestAnimationFrame(() => {
          frames++;
          renderer.render(scene, camera);
          if (areOn(renderer, { reveal: false })) resolve();
        });
      });
    });
    renderer.render(scene, camera);
    await revealed;
    return { shown, hidden, frames, revealed: await shot(stage) };
  },

  /**
   * Whether splats look for occluders as objects are added: some that cannot hide them, then one
   * that does.
   */
  occluders: async () => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const cloud = splatCloud({});
    scene.add(cloud);
    const tested: Record<string, boolean> = {};
    const note = async (what: string) => {
      const pixels = await shot(stage);
      tested[what] = areOn(renderer, { 'depth-test': true });
      return pixels;
    };
    await note('nothing');
    scene.add(wall(0x0000ff, -0.5, { depthWrite: false }));
    await note('sky');
    const later = wall(0x00ff00, 0.9, { transparent: true, opacity: 0 });
    later.renderOrder = 1;
    scene.add(later);
    await note('later');
    const front = rightHalf(wall(0xff0000, 0.5));
    scene.add(front);
    // Not one frame without splats, though other shaders are needed.
    const { framesDrawn } = splatEngineOf(renderer).counters();
    renderer.render(scene, camera);
    const isDrawnAtOnce = splatEngineOf(renderer).counters().framesDrawn === framesDrawn + 1;
    const pixels = await shotWith(stage, { 'depth-test': true });
    front.removeFromParent();
    await note('nothing again');
    return { tested, isDrawnAtOnce, pixels };
  },

  /** A cloud that asks for more than was loaded, then for less, then for the impossible. */
  cloudAccuracy: async () => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const engine = splatEngineOf(renderer);
    const data = await new SplatLoader().loadAsync(new Blob([encodePly(testScene()) as BlobPart]));
    const cloud = new SplatCloudObjectClass(data);
    const held = () => {
      const { geometry, sh } = cloud.uploadedTo(engine)!.precisions;
      return [...geometry, ...sh].join(' ');
    };
    const becomes = async (precisions: string) => {
      await until(() => held() === precisions);
      return held();
    };
    const errors = errorsOf(cloud);
    lookAtTestScene(camera);
    scene.add(cloud);
    const balanced = await shot(stage);
    const loaded = held();
    cloud.accuracy = 'reference';
    await shot(stage);
    const finer = await becomes('f32 f32');
    const reference = await shot(stage);
    cloud.accuracy = 'fast';
    await shot(stage);
    const coarser = await becomes('packed u8');
    // Beside one that asks for nothing and cannot be read again.
    const other = new SplatCloudObjectClass(
      new SplatData(packCloud(testScene(), { geometryPrecision: 'packed', shPrecision: 'u8' }), 'no source'),
    );
    const otherErrors = errorsOf(other);
    scene.add(other);
    cloud.accuracy = { sortKeyBits: 16 };
    other.accuracy = 'reference';
    await shot(stage);
    const together = await becomes('f32 f32');
    await shot(stage);
    await until(() => otherErrors.length > 0);
    return {
      held: { loaded, finer, coarser, together },
      errors,
      otherErrors,
      images: { balanced, reference },
      ...cameraOf(camera),
    };
  },

  /** A cloud that asks for an outcome. */
  targetAccuracy: async (minPsnrDb: number) => {
    const stage = await newStage();
    const { scene, camera } = stage;
    const data = await new SplatLoader().loadAsync(new Blob([encodePly(testScene()) as BlobPart]));
    const cloud = new SplatCloudObjectClass(data);
    cloud.accuracy = { minPsnrDb };
    const tooEarly = await cloud.chooseAccuracy().catch(({ name }: Error) => name);
    const choices: AccuracyChoice[] = [];
    const chosen = new Promise<void>((resolve) => {
      cloud.addEventListener('accuracychosen', ({ choice }) => {
        choices.push(choice);
        resolve();
      });
    });
    lookAtTestScene(camera);
    scene.add(cloud);
    await shot(stage);
    await chosen;
    const image = await shot(stage);
    const { isMet, why, point } = choices[0];
    const again = await cloud.chooseAccuracy();
    await Promise.resolve();
    return {
      tooEarly,
      isMet,
      why,
      psnrDb: point.error.psnrDb,
      isToldAgain: choices[1] === again,
      image,
      ...cameraOf(camera),
    };
  },

  /** Uploads and frees while clouds come and go. */
  uploads: async () => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const engine = splatEngineOf(renderer);
    const start = { counters: engine.counters(), bytes: engine.memory().totalBytes };
    const first = splatCloud({});
    scene.add(first);
    await shot(stage);
    const one = engine.counters();
    const second = splatCloud({ position: [0, 0, 1] });
    const copy = new SplatCloudObjectClass(second.data);
    scene.add(second, copy);
    await shot(stage);
    scene.remove(copy);
    await shot(stage);
    scene.remove(second);
    await shot(stage);
    scene.add(second);
    await shot(stage);
    const end = engine.counters();
    const childrenWith = scene.children.length;
    scene.remove(first, second);
    await Promise.resolve();
    const childrenAfter = scene.children.length;
    for (const cloud of [first, second, copy]) cloud.dispose();
    renderer.render(scene, camera);
    const bytesLeft = () => engine.memory().totalBytes - start.bytes;
    await until(() => bytesLeft() === 0);
    return {
      uploadsOfOne: one.uploads - start.counters.uploads,
      uploadsInAll: end.uploads - start.counters.uploads,
      childrenWith,
      childrenAfter,
      bytesLeft: bytesLeft(),
    };
  },

  /**
   * A file with as many rows as the GPU packs: loaded for a renderer and drawn by it, drawn again
   * after it was freed, and drawn by another renderer; and the same file packed on the CPU.
   * `packedOnCpu` is the number of clouds that the first renderer's engine packed on the CPU.
   */
  loadedForRenderer: async () => {
    const stages = [await newStage(BY_TILES), await newStage({ ...BY_TILES, antialias: false })];
    const [stage, otherStage] = stages;
    const engine = splatEngineOf(stage.renderer);
    const start = engine.memory().totalBytes;
    let packedOnCpu = 0;
    const addPacked = engine.addPacked.bind(engine);
    engine.addPacked = (...args) => {
      packedOnCpu++;
      return addPacked(...args);
    };
    // Nine in ten are too faint to be drawn: all are packed, but SwiftShader takes seconds to draw them.
    const splats = manySplats(70_000).map((splat, i) => (i % 10 ? { ...splat, opacity: 0.002 } : splat));
    const file = new Blob([encodePly(splatSet(splats)) as BlobPart]);
    const data = await new SplatLoader().detectSupport(stage.renderer).loadAsync(file);
    const bytesLoaded = engine.memory().totalBytes - start;
    const cloud = new SplatCloudObjectClass(data);
    const errors = errorsOf(cloud);
    const draw = async (where: Stage) => {
      where.scene.add(cloud);
      const image = await shot(where);
      cloud.removeFromParent();
      return image;
    };
    const volume = new Sphere(new Vector3(0.5, 0.2, -0.3), 0.4);
    const images = { first: await draw(stage), again: null as Pixels | null, other: null as Pixels | null };
    const rows = { onGpu: [...(await data.rowsIn(volume))], readAgain: null as number[] | null };
    cloud.dispose();
    await Promise.resolve();
    const bytesDisposed = engine.memory().totalBytes - start;
    rows.readAgain = [...(await data.rowsIn(volume))];
    images.again = await draw(stage);
    images.other = await draw(otherStage);
    cloud.dispose();
    const onCpu = await new SplatLoader().loadAsync(file);
    cloud.data = onCpu;
    const inMemory = [...(await onCpu.rowsIn(volume))];
    const result = { packedOnCpu, bytesLoaded, bytesDisposed, errors };
    const cpu = await draw(stage);
    cloud.dispose();
    engine.addPacked = addPacked;
    await Promise.resolve();
    const bytesLeft = engine.memory().totalBytes - start;
    return { ...result, bytesLeft, images: { ...images, cpu }, rows: { ...rows, inMemory } };
  },

  /** Shows the file at `address` and keeps it until `letGo`. */
  keepShown: async (how: 'renderer' | 'memory' | 'buffer', address: string) => {
    const stage = await newStage();
    const loader = new SplatLoader();
    if (how === 'renderer') loader.detectSupport(stage.renderer);
    const source = how === 'buffer' ? await (await fetch(address)).arrayBuffer() : address;
    kept = new SplatCloudObjectClass(await loader.loadAsync(source));
    stage.scene.add(kept);
    await shot(stage);
    await kept.data!.prepareRays();
    kept.removeFromParent();
  },

  letGo: async () => {
    kept?.dispose();
    kept = null;
  },

  /** Loads for a renderer that fail, are aborted or are never shown, and the bytes that remain. */
  failedLoads: async () => {
    const { renderer } = await newStage();
    const engine = splatEngineOf(renderer);
    const start = engine.memory().totalBytes;
    const bytes = encodePly(splatSet(manySplats(70_000))) as Uint8Array<ArrayBuffer>;
    const outcomes: Record<string, { readonly error: string; readonly bytesLeft: number }> = {};
    const note = async (name: string, load: Promise<unknown>) => {
      const error = await load.then(
        () => 'none',
        (reason: Error) => reason.name,
      );
      outcomes[name] = { error, bytesLeft: engine.memory().totalBytes - start };
    };
    const loader = new SplatLoader().detectSupport(renderer);
    await note('cut short', loader.loadAsync(new Blob([bytes.subarray(0, bytes.length - 1000)])));
    await note(
      'aborted',
      loader.loadAsync(new Blob([bytes]), () => void loader.abort()),
    );
    const disposed = loader.loadAsync(new Blob([bytes])).then((data) => data.dispose());
    await note('disposed', disposed);
    return outcomes;
  },

  /** A load that its renderer does not survive, shown by the next one. */
  loadBeyondDevice: async () => {
    const lost = await makeRenderer({});
    const bytes = encodePly(splatSet(manySplats(70_000))) as BlobPart;
    let isLost = false;
    const loader = new SplatLoader().detectSupport(lost);
    const data = await loader.loadAsync(new Blob([bytes]), () => {
      if (!isLost) splatEngineOf(lost).device.destroy();
      isLost = true;
    });
    const stage = await newStage();
    stage.scene.add(new SplatCloudObjectClass(data));
    const { data: pixels } = await shot(stage);
    await lost.dispose();
    return { isLost, isDrawn: pixels.some((value, i) => i % 4 < 3 && value > 50) };
  },

  /** Nothing is prepared again where nothing has moved. */
  stillness: async () => {
    const stage = await newStage();
    stage.scene.add(splatCloud({}));
    await shot(stage);
    const engine = splatEngineOf(stage.renderer);
    const before = engine.counters().framesPrepared;
    for (let i = 0; i < 3; i++) await shot(stage);
    const still = engine.counters().framesPrepared - before;
    stage.camera.position.x = 0.1;
    await shot(stage);
    return { still, moved: engine.counters().framesPrepared - before };
  },

  /** Samples that are thrown away at the end of three's pass cannot be taken up again. */
  discardedSamples: async () => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const cloud = splatCloud({});
    const errors = errorsOf(cloud);
    scene.add(rightHalf(wall(0xff0000, 0.5)), cloud);
    await shot(stage);
    const target = new RenderTarget(SIZE_PX, SIZE_PX, { type: HalfFloatType, samples: 4 });
    target.storeMultisampledColorBuffer = false;
    for (let i = 0; i < 2; i++) {
      renderer.setRenderTarget(target);
      renderer.render(scene, camera);
    }
    renderer.setRenderTarget(null);
    // Messages for rare cases are loaded.
    await until(() => errors.length > 0);
    return { errors, inTarget: await targetPixels(renderer, target), after: await shot(stage) };
  },

  /**
   * Two faces of a cube camera: a white splat on the right; on the left a red wall that hides half
   * of another splat.
   */
  cubeCamera: async () => {
    const stage = await newStage();
    const { renderer, scene } = stage;
    const target = new CubeRenderTarget(SIZE_PX, { type: HalfFloatType });
    const cube = new CubeCamera(0.1, 100, target);
    const upright = [0.001, 500, 500] as const;
    const hiding = new Mesh(new PlaneGeometry(20, 20), new MeshBasicMaterial({ color: 0xff0000 }));
    hiding.rotation.y = Math.PI / 2;
    hiding.position.set(-1, 10, 0);
    scene.add(
      cube,
      hiding,
      splatCloud({ position: [2, 0, 0], scale: upright }, { position: [-2, 0, 0], scale: upright }),
    );
    await drawn(renderer, scene, () => cube.update(renderer, scene), 6);
    const faces: Pixels[] = [];
    for (const face of [0, 1]) faces.push(await targetPixels(renderer, target, face));
    return faces;
  },

  /** A viewport that is larger than the canvas and begins outside of it. */
  viewportBeyondCanvas: async (hasOutputPass: boolean) => {
    const stage = await newStage();
    if (!hasOutputPass) stage.renderer.outputColorSpace = LinearSRGBColorSpace;
    stage.renderer.setViewport(-16, -16, SIZE_PX + 32, SIZE_PX + 32);
    stage.scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    return shot(stage);
  },

  /** A mask before the splats decides about a wall after them. */
  stencil: async () => {
    const stage = await newStage({ stencil: true });
    const mask = rightHalf(
      wall(0xff0000, -0.5, {
        stencilWrite: true,
        stencilRef: 5,
        stencilZPass: ReplaceStencilOp,
        stencilFail: KeepStencilOp,
      }),
    );
    const masked = wall(0x00ff00, 0.5, {
      transparent: true,
      stencilWrite: true,
      stencilRef: 5,
      stencilFunc: EqualStencilFunc,
    });
    masked.renderOrder = 1;
    stage.scene.add(mask, masked, splatCloud({}));
    return shot(stage);
  },

  occlusionQuery: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const tested = rightHalf(wall(0xff0000, 0.5));
    tested.occlusionTest = true;
    stage.scene.add(tested, splatCloud({}));
    return shot(stage);
  },

  bundleGroup: async (parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    const group = new BundleGroup();
    group.add(rightHalf(wall(0xff0000, 0.5)), wall(0x0000ff, -0.5));
    stage.scene.add(group, splatCloud({}));
    return shot(stage);
  },

  overrideMaterial: async () => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    scene.add(rightHalf(wall(0xff0000, 0.5)), splatCloud({}));
    await shot(stage);
    scene.overrideMaterial = new MeshBasicMaterial({ color: 0x00ff00 });
    return meshShot({ renderer, scene, camera });
  },

  /** A mesh over half of one pixel, so that its samples differ: the image along its edge. */
  multisampledEdge: async () => {
    const stage = await newStage({ antialias: true });
    const mesh = rightHalf(wall(0xffffff, -0.5));
    mesh.rotation.z = 0.3;
    stage.scene.add(mesh);
    const without = await meshShot(stage);
    stage.scene.add(splatCloud({ color: [0, 0, 0], opacity: 0.5 }));
    return { without, with: await shot(stage) };
  },

  /** Pictures of instances and of as many objects, and the hits in the middle of the instances. */
  instances: async () => {
    const { renderer, scene, camera } = await newStage(BY_TILES);
    const data = splatData(...manySplats(400));
    const places = [-1.2, 0, 1.2].map((x, i) =>
      new Matrix4()
        .makeRotationY(i)
        .scale(new Vector3(0.4, 0.5, 0.4))
        .setPosition(x, 0.1 * i, -0.2 * i),
    );
    const colors = ['white', 'orange', '#8080ff'].map((color) => new Color(color));
    const cloud = new SplatCloudObjectClass(data);
    const errors = errorsOf(cloud);
    const instances = new SplatInstances(places.length);
    for (const [i, place] of places.entries()) {
      instances.setMatrixAt(i, place);
      instances.setColorAt(i, colors[i]);
      instances.setOpacityAt(i, 1 - 0.2 * i);
    }
    cloud.instances = instances;
    const objects = places.map((_, i) => {
      const object = new SplatCloudObjectClass(data);
      object.matrixAutoUpdate = false;
      object.matrix.copy(instances.getMatrixAt(i, new Matrix4()));
      object.opacity = instances.getOpacityAt(i);
      object.effects = [tint(encodedColor(instances.getColorAt(i, new Color())))];
      return object;
    });
    const group = new Group();
    group.rotation.x = 0.3;
    group.scale.setScalar(1.1);
    scene.add(group.add(cloud));
    const together = await shot({ renderer, scene, camera });
    const middle = SIZE_PX / 2;
    const hit = await cloud.pick(renderer, camera, middle, middle);
    await data.prepareRays();
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(0, 0), camera);
    const [ray] = caster.intersectObjects(scene.children);
    cloud.removeFromParent();
    group.add(...objects);
    const apart = await shot({ renderer, scene, camera });
    return { together, apart, errors, picked: hit?.instanceId, met: ray?.instanceId };
  },

  pickAndRaycast: async () => {
    const stage = await newStage();
    const { renderer, scene, camera } = stage;
    const small = [0.1, 0.1, 0.1] as const;
    const left = splatCloud(
      { position: [0.2, 0, 0], scale: small, opacity: 0.9 },
      { position: [-0.5, 0, 0], scale: small, opacity: 0.9 },
    );
    const right = splatCloud({ scale: small, opacity: 0.9 });
    left.scale.setScalar(2);
    right.position.set(0, 0.8, 0);
    scene.add(left, right);
    await shot(stage);
    const middle = SIZE_PX / 2;
    const xPx = middle - (1 / Math.sqrt(3)) * middle * (1 / 1.0) * (1 / 1.0);
    const hit = await left.pick(renderer, camera, xPx, middle);
    await left.data!.prepareRays();
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(-1 / Math.sqrt(3), 0), camera);
    const [ray] = caster.intersectObjects(scene.children);
    return {
      pick: hit && { row: hit.row, point: hit.point.toArray(), isOwn: hit.object === left },
      otherCloud: await right.pick(renderer, camera, xPx, middle),
      nothing: await left.pick(renderer, camera, 1, 1),
      ray: ray && { isLeft: ray.object === left, distance: ray.distance, point: ray.point.toArray() },
    };
  },

  /**
   * Frames of a loop that nothing but the GPU holds back until the answers of `pick` and
   * `prepareRays`: of a canvas that is not on the screen. At most `most` are counted.
   */
  framesUntilAnswers: async (most: number) => {
    const widthPx = 128;
    const renderer = await makeRenderer({});
    renderer.domElement.remove();
    renderer.setSize(widthPx, widthPx, false);
    const { scene, camera } = newScene();
    const file = new Blob([encodePly(splatSet(manySplats(8000))) as BlobPart]);
    const data = await new SplatLoader().detectSupport(renderer).loadAsync(file);
    const cloud = new SplatCloudObjectClass(data);
    scene.add(cloud);
    let frames = 0;
    const inFrame: ((frame: number) => void)[] = [];
    const first = new Promise((resolve) => cloud.addEventListener('firstframe', resolve));
    await renderer.setAnimationLoop(() => {
      frames++;
      camera.position.x = 0.3 * Math.sin(frames / 10);
      renderer.render(scene, camera);
      for (const listener of inFrame) listener(frames);
    });
    const whenFrame = (frame: number) =>
      new Promise<void>((resolve) => inFrame.push((now) => now >= frame && resolve()));
    await first;
    await whenFrame(frames + 10);
    const framesUntil = async (answer: () => Promise<unknown>) => {
      const before = frames;
      await Promise.race([answer(), whenFrame(before + most)]);
      return frames - before;
    };
    const pick = () => cloud.pick(renderer, camera, widthPx / 2, widthPx / 2);
    const counted = {
      firstPick: await framesUntil(pick),
      pick: await framesUntil(pick),
      prepareRays: await framesUntil(() => data.prepareRays()),
    };
    const found = await pick();
    await renderer.setAnimationLoop(null);
    await renderer.dispose();
    return { ...counted, isFound: found !== null };
  },

  stageTimings: async () => {
    const stage = await newStage();
    stage.scene.add(splatCloud({}));
    const measured = new Promise<number>((resolve) => {
      const stop = onStageTimings(stage.renderer, ({ visibleSplats }) => {
        stop();
        resolve(visibleSplats);
      });
    });
    await shot(stage);
    stage.camera.position.x = 0.1;
    await shot(stage);
    return measured;
  },

  deviceLoss: async () => {
    const renderer = await makeRenderer({});
    const told: string[] = [];
    onDeviceLost(renderer, ({ reason }) => told.push(reason));
    splatEngineOf(renderer).device.destroy();
    await splatEngineOf(renderer).lost;
    const disposed = await makeRenderer({});
    onDeviceLost(disposed, () => told.push('disposed'));
    await disposed.dispose();
    await splatEngineOf(disposed).lost;
    const { renderer: foreign } = await foreignStage();
    onDeviceLost(foreign, ({ reason }) => told.push(`foreign ${reason}`));
    const { device, lost } = splatEngineOf(await adoptRenderer(foreign));
    device.destroy();
    await lost;
    await nextFrame();
    return told;
  },
};
