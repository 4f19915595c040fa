import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import { brickSceneOf } from '../data/bricks/make-bricks.ts';
import { cameraFromMatrices } from '../data/camera/camera.ts';
import { packGeometry } from '../data/packing/geometry.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import { packHarmonics } from '../data/packing/repack-harmonics.ts';
import { colorDcOf, logitOf } from '../data/splats/color-values.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { followEdits } from '../features/edits/edits.clouds.ts';
import { SplatEdits } from '../features/edits/splat-edits.data.ts';
import { followMorph } from '../features/morph/morph.clouds.ts';
import { morphGeometry, morphSh } from '../features/morph/morph.reference.ts';
import { SplatMorph } from '../features/morph/splat-morph.data.ts';
import { MOTION_SLOT, MOTION_VALUES } from '../features/motion/splat-motion.data.ts';
import { followSkin } from '../features/skin/skin.clouds.ts';
import { skinGeometry } from '../features/skin/skin.reference.ts';
import { SplatSkin } from '../features/skin/splat-skin.data.ts';
import type { CloudInstance, FrameRequest } from '../frame/plan/frame-request.ts';
import { defineEffect } from '../gpu/effects/define-effect.ts';
import type { EffectUse } from '../gpu/effects/effect.ts';
import { effectResources } from '../gpu/effects/effect-resources.ts';
import { relight } from '../gpu/effects/relight/relight.ts';
import type { MapDepths } from '../gpu/effects/shadows/shadows.reference.ts';
import { shadows } from '../gpu/effects/shadows/shadows.ts';
import { splatRows } from '../gpu/effects/splat-rows.ts';
import type { ReferenceFunction } from '../reference/effects/references.ts';
import type { ReferenceFrame } from '../reference/render.ts';
import { EFFECT_EXAMPLES } from './effect-examples.ts';
import { paletteSplats, withOwnCoefficients } from './palette-splats.ts';
import { randomSplats } from './random-splats.ts';
import { seededRandom } from './seeded-random.ts';
import { testCameras } from './test-cameras.ts';

/** Something that can take part in a frame beside others, on one cloud. */
export interface FrameMember {
  readonly name: string;
  /** Changes the splats before they are loaded. */
  readonly set?: (set: SplatSet<Harmonics>) => SplatSet<Harmonics>;
  /** Makes the cloud in its own way; default `engine.add`. */
  readonly load?: (engine: SplatEngine, set: SplatSet<Harmonics>) => SplatCloud | Promise<SplatCloud>;
  /** Attaches to the cloud. `edits` are those of all members. */
  readonly follow?: (cloud: SplatCloud, edits: SplatEdits) => void | Promise<void>;
  readonly instance?: Partial<Omit<CloudInstance, 'effects'>>;
  readonly effect?: EffectUse;
  readonly request?: Partial<Pick<FrameRequest, 'camera' | 'detail' | 'sortBy'>>;
  readonly accuracy?: Partial<AccuracySettings>;
  /** What float64 draws instead of the splats, in the order of the members. */
  readonly asSplats?: (set: SplatSet<Harmonics>) => SplatSet<Harmonics>;
}

/** Splats of a scene that members take part in. */
const MEMBER_COUNT = 200;
const SEED = 76;

const HEAD = 'import package::lib::packing::Splat;\n';
const COLOR = '(color: vec3f, splat: Splat, index: u32, centerView: vec3f) -> vec3f';

/** Named like helpers of the engine, of other effects and of WGSL. */
const nameless = defineEffect({
  name: 'own-names',
  label: 'Own names',
  about: 'Has names that others have.',
  hooks: { color: 'changeColor' },
  fields: { loop1: 'f32' },
  wgsl: `${HEAD}import parameters::OwnNames;
const PI = 0.25;
struct Surface { center: f32 }
fn noise(x: f32) -> f32 { return x * PI; }
fn lightLeft(x: f32) -> f32 { return noise(x); }
fn edgeFade(s: Surface) -> f32 { return lightLeft(s.center); }
fn max(x: f32) -> f32 { return edgeFade(Surface(x)); }
fn rotationMatrix(x: f32) -> f32 { return max(x); }
fn changeColor(color: vec3f, splat: Splat, index: u32, centerView: vec3f, own: OwnNames) -> vec3f {
  return color.gbr + vec3f(rotationMatrix(own.loop1));
}`,
  calledFor: () => 'names meet',
  valuesAt: () => ({ loop1: 0.2 }),
});

/** Its hook has the name of a local of the generated functions, and its name is that of a struct. */
const moving = defineEffect({
  name: 'view',
  label: 'Own move',
  about: 'Moves splats.',
  hooks: { splat: 'changed' },
  fields: { by: 'f32' },
  wgsl: `${HEAD}import parameters::View;
fn noise(x: f32) -> vec3f { return vec3f(x, 0.5 * x, 0.0); }
fn changed(splat: Splat, index: u32, own: View) -> Splat {
  var moved = splat;
  moved.position += noise(own.by);
  return moved;
}`,
  calledFor: () => 'splats move',
  valuesAt: () => ({ by: 0.1 }),
  reach: () => ({ displacement: 0.12, growth: 1 }),
});

const byRow = defineEffect<{ values: GPUBuffer }>({
  name: 'own-rows',
  label: 'Own rows',
  about: 'Colours splats by values of their rows.',
  hooks: { color: 'noise' },
  rows: splatRows,
  resources: effectResources({ values: 'array<f32>' }, ({ values }) => ({ values })),
  wgsl: `${HEAD}import parameters::ownRowsValues;
fn noise(color: vec3f, splat: Splat, index: u32, centerView: vec3f, row: u32) -> vec3f {
  return color * ownRowsValues[row];
}`,
  calledFor: () => 'rows have values',
});

const painted = defineEffect<{ image: GPUTexture }>({
  name: 'own-image',
  label: 'Own image',
  about: 'Colours splats by a texel.',
  hooks: { color: 'paint' },
  resources: effectResources({ image: 'texels' }, ({ image }) => ({ image })),
  wgsl: `${HEAD}import parameters::ownImageImage;
fn paint${COLOR} { return color * textureLoad(ownImageImage, vec2u(0u), 0).rgb; }`,
  calledFor: () => 'an image is there',
});

/** Values of rows, 0.5…1. */
const rowValue = (row: number) => 0.5 + (row % 64) / 128;

/** References of the members' own effects. */
const MEMBER_REFERENCES: Readonly<Record<string, ReferenceFunction>> = {
  'own-names': () => ({ changeColor: ([r, g, b]) => [g + 0.05, b + 0.05, r + 0.05] }),
  view: () => ({
    changeSplat: ({ position: [x, y, z], ...splat }) => ({ ...splat, position: [x + 0.1, y + 0.05, z] }),
  }),
  'own-rows': () => ({
    changeColor: ([r, g, b], { row }) => [r * rowValue(row), g * rowValue(row), b * rowValue(row)],
  }),
  'own-image': () => ({ changeColor: ([r, g, b]) => [r, (g * 102) / 255, (b * 204) / 255] }),
};

/** A map of a light above, and the depths in it: a floor at half of its depths. */
function sunWithMap(device: GPUDevice) {
  const FROM_ABOVE = [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -4, 1];
  const [near, far] = [0.5, 8];
  const camera = cameraFromMatrices(
    FROM_ABOVE,
    [0.6, 0, 0, 0, 0, 0.8, 0, 0, 0, 0, -1 / (far - near), 0, 0, 0, -near / (far - near), 1],
    { near, far },
  );
  const { RENDER_ATTACHMENT, TEXTURE_BINDING } = GPUTextureUsage;
  const size = { widthPx: 4, heightPx: 4 };
  const map = device.createTexture({
    size: [size.widthPx, size.heightPx],
    format: 'depth32float',
    usage: RENDER_ATTACHMENT | TEXTURE_BINDING,
  });
  const depth = 0.45;
  const encoder = device.createCommandEncoder();
  const attachment = {
    view: map.createView(),
    depthClearValue: depth,
    depthLoadOp: 'clear',
    depthStoreOp: 'store',
  } as const;
  encoder.beginRenderPass({ colorAttachments: [], depthStencilAttachment: attachment }).end();
  device.queue.submit([encoder.finish()]);
  const depths: MapDepths = { ...size, depths: new Float32Array(size.widthPx * size.heightPx).fill(depth) };
  return { light: { map, camera, irradiance: [3, 2.5, 2] as const, version: 1 }, depths };
}

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const BENT = [0.643, 0.766, 0, 0, -0.766, 0.643, 0, 0, 0, 0, 1, 0, 0.1, -0.2, 0.1, 1];
const WEIGHTS = {
  indices: Array.from({ length: 4 * MEMBER_COUNT }, (_, k) => (k % 4 === 1 ? 1 : 0)),
  weights: Array.from({ length: 4 * MEMBER_COUNT }, (_, k) => {
    const right = ((k >> 2) % 5) / 4;
    return [1 - right, right, 0, 0][k % 4];
  }),
};
const MORPHED = 0.4;
const EDITED = Uint32Array.from({ length: MEMBER_COUNT / 4 }, (_, i) => 4 * i + 1);
const REMOVED = Uint32Array.from({ length: MEMBER_COUNT / 4 }, (_, i) => 4 * i + 2);
/** Matrices of instances, relative to the cloud. */
const PLACES = [IDENTITY, [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0.4, 0.3, -0.2, 1]];
const TIME = 0.4;

function moved(set: SplatSet<Harmonics>): SplatSet<Harmonics> {
  const random = seededRandom(SEED);
  const motion = new Float32Array(set.count * MOTION_VALUES);
  for (let i = 0; i < set.count; i++) {
    const at = i * MOTION_VALUES;
    motion[at + MOTION_SLOT.time] = random();
    motion[at + MOTION_SLOT.logDuration] = -1 + 3 * random();
    for (let k = 0; k < 9; k++) motion[at + MOTION_SLOT.velocity + k] = random() - 0.5;
    for (let k = 0; k < 4; k++) motion[at + MOTION_SLOT.turn + k] = random() - 0.5;
  }
  return { ...set, motion };
}

function posed(set: SplatSet<Harmonics>): SplatSet<Harmonics> {
  const rows = [IDENTITY, BENT].flatMap((matrix) =>
    [0, 1, 2].flatMap((row) => [0, 4, 8, 12].map((column) => matrix[column + row])),
  );
  const splats = skinGeometry(packGeometry(set, 'f32'), new SplatSkin(WEIGHTS, 2).words, rows, set.count);
  return {
    ...set,
    positions: Float32Array.from(splats.flatMap(({ position }) => position)),
    logScales: Float32Array.from(splats.flatMap(({ scale }) => scale.map(Math.log))),
    rotations: Float32Array.from(splats.flatMap(({ rotation }) => rotation)),
  };
}

/** The splats that the cloud morphs to. */
function target({ count, harmonics, isAntialiased }: SplatSet<Harmonics>): SplatSet {
  const set = randomSplats({ count, shDegree: harmonics.degree, seed: SEED + 1, logScales: [-4, -2] });
  return { ...set, isAntialiased };
}

function blended(set: SplatSet<Harmonics>): SplatSet<Harmonics> {
  const [from, to] = [set as SplatSet, target(set)];
  const [a, b] = [from, to].map((each) => packGeometry(each, 'f32'));
  const splats = morphGeometry(a, b, set.count, MORPHED);
  const [c, d] = [from, to].map(({ harmonics }) => packHarmonics(harmonics));
  const { degree, words } = morphSh(c, d, set.count, MORPHED);
  return {
    ...set,
    positions: Float32Array.from(splats.flatMap(({ position }) => position)),
    logScales: Float32Array.from(splats.flatMap(({ scale }) => scale.map(Math.log))),
    rotations: Float32Array.from(splats.flatMap(({ rotation }) => rotation)),
    opacityLogits: Float32Array.from(splats, ({ opacity }) => logitOf(opacity)),
    colorDc: Float32Array.from(splats.flatMap(({ colorDc }) => colorDc)),
    harmonics: { degree, coefficients: new Float32Array(words.buffer) },
  };
}

/**
 * Everything that can take part in a frame, each by one line: tests draw all pairs. `device` holds the
 * textures and buffers of some effects.
 */
export function frameMembers(device: GPUDevice): readonly FrameMember[] {
  const sun = sunWithMap(device);
  const shadowed = shadows({ lights: [sun.light], steady: [1, 1.2, 1.5] });
  const values = device.createBuffer({
    size: 4 * MEMBER_COUNT,
    usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST,
  });
  device.queue.writeBuffer(
    values,
    0,
    Float32Array.from({ length: MEMBER_COUNT }, (_, row) => rowValue(row)),
  );
  const image = device.createTexture({
    size: [1, 1],
    format: 'rgba8unorm',
    usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
  });
  device.queue.writeTexture({ texture: image }, Uint8Array.of(255, 102, 204, 255), {}, [1, 1]);
  const lights = [
    { kind: 'directional', direction: [1, -3, -2], irradiance: [3, 2.5, 2] },
    { kind: 'point', position: [0.5, 0.7, 0.2], irradiance: [1, 2, 3], distance: 2.5 },
  ] as const;
  const cameras = testCameras(1);
  return [
    ...EFFECT_EXAMPLES.map((effect) => ({ name: effect.effect.name, effect })),
    { name: 'relight', effect: relight({ lights, ambient: [0.4, 0.5, 0.6] }) },
    {
      name: 'shadows',
      effect: { ...shadowed, options: { ...(shadowed.options as object), depthsOf: () => sun.depths } },
    },
    { name: 'own names', effect: nameless() },
    { name: 'own move', effect: moving() },
    { name: 'own rows', effect: byRow({ values }) },
    { name: 'own image', effect: painted({ image }) },
    { name: 'motion', set: moved, instance: { time: TIME } },
    { name: 'palette', set: (set) => ({ ...set, harmonics: paletteOf(set) }), asSplats: withOwn },
    { name: 'antialiased file', set: (set) => ({ ...set, isAntialiased: true }) },
    {
      name: 'morph',
      async load(engine, set) {
        const morph = new SplatMorph(set as SplatSet, target(set), engine.resolveAccuracy().settings);
        const cloud = engine.addPacked(morph.packed);
        await followMorph(cloud, morph);
        morph.amount = MORPHED;
        return cloud;
      },
      asSplats: blended,
    },
    { name: 'stream', load: (engine, set) => engine.stream(brickSceneOf(set)) },
    {
      name: 'skin',
      async follow(cloud) {
        const skin = new SplatSkin(WEIGHTS, 2);
        await followSkin(cloud, skin);
        skin.setPose([...IDENTITY, ...BENT]);
      },
      asSplats: posed,
    },
    {
      name: 'edits',
      async follow(cloud, edits) {
        edits.set(EDITED, { colors: [0.9, 0.2, 0.1], opacities: [0.5] });
        await followEdits(cloud, edits);
      },
      asSplats(set) {
        const [colorDc, opacityLogits] = [set.colorDc.slice(), set.opacityLogits.slice()];
        for (const row of EDITED) {
          colorDc.set([0.9, 0.2, 0.1].map(colorDcOf), 3 * row);
          opacityLogits[row] = 0;
        }
        return { ...set, colorDc, opacityLogits };
      },
    },
    {
      name: 'removed',
      async follow(cloud, edits) {
        edits.set(REMOVED, { visible: false });
        await followEdits(cloud, edits);
      },
      asSplats(set) {
        const opacityLogits = set.opacityLogits.slice();
        for (const row of REMOVED) opacityLogits[row] = Number.NEGATIVE_INFINITY;
        return { ...set, opacityLogits };
      },
    },
    { name: 'instances', instance: { instances: { modelMatrices: PLACES.flat() } } },
    { name: 'opacity of the cloud', instance: { opacity: 0.7 } },
    { name: 'levels', request: { detail: { maxErrorPx: 0 } } },
    { name: 'a budget', request: { detail: { maxSplats: 100_000 } } },
    { name: 'order by distance', request: { sortBy: 'distance' } },
    { name: 'orthographic camera', request: { camera: cameras.orthographic } },
    { name: 'lower degree', instance: { shDegree: 0 } },
    { name: 'lower resolution', accuracy: { resolutionScale: 0.5 } },
    { name: 'tiles', accuracy: { rasterizer: 'tiles' } },
    { name: 'packed splats', accuracy: { geometryPrecision: 'packed', shPrecision: 'u8' } },
  ] satisfies FrameMember[];
}

function paletteOf(set: SplatSet<Harmonics>): Harmonics {
  return paletteSplats({ count: set.count, shDegree: set.harmonics.degree, entryCount: 20, seed: SEED })
    .harmonics;
}

function withOwn(set: SplatSet<Harmonics>): SplatSet<Harmonics> {
  return 'entries' in set.harmonics ? withOwnCoefficients(set as never) : set;
}

/** A frame of members on one cloud, and the same for the reference. */
export interface MemberFrame {
  readonly request: Pick<FrameRequest, 'camera' | 'clouds' | 'detail' | 'sortBy'>;
  readonly reference: Omit<ReferenceFrame, 'widthPx' | 'heightPx'>;
}

/** A cloud with the members that change it, and the splats that float64 draws. */
interface MemberCloud {
  readonly cloud: SplatCloud;
  readonly drawn: SplatSet<Harmonics>;
}

/** Makes frames of members, with one engine for each accuracy and one cloud for each set of members that change it. */
export class MemberFrames {
  readonly #device: GPUDevice;
  readonly #engines = new Map<string, Promise<SplatEngine>>();
  readonly #clouds = new Map<string, Promise<MemberCloud>>();

  constructor(device: GPUDevice) {
    this.#device = device;
  }

  engineFor(members: readonly FrameMember[]): Promise<SplatEngine> {
    const accuracy = Object.assign({ preset: 'reference' }, ...members.map((member) => member.accuracy));
    const key = JSON.stringify(accuracy);
    const engine = this.#engines.get(key) ?? SplatEngine.create({ device: this.#device, accuracy });
    this.#engines.set(key, engine);
    return engine;
  }

  /** @throws the errors by which members refuse each other. */
  async frameOf(members: readonly FrameMember[]): Promise<MemberFrame> {
    const engine = await this.engineFor(members);
    const changing = members.filter(({ set, load, follow }) => set || load || follow);
    const key = JSON.stringify([engine.accuracy, changing.map(({ name }) => name)]);
    const made = this.#clouds.get(key) ?? cloudOf(engine, changing);
    this.#clouds.set(key, made);
    const { cloud, drawn } = await made;
    const effects = members.flatMap(({ effect }) => effect ?? []);
    const instance: Partial<CloudInstance> = Object.assign({}, ...members.map((member) => member.instance));
    const asked: MemberFrame['request'] = Object.assign(
      { camera: testCameras(1).perspective },
      ...members.map(({ request }) => request),
    );
    const { instances, ...placed } = instance;
    return {
      request: { ...asked, clouds: [{ cloud, ...instance, effects }] },
      reference: {
        camera: asked.camera,
        sortBy: asked.sortBy,
        effectReferences: MEMBER_REFERENCES,
        clouds: (instances ? PLACES : [IDENTITY]).map((modelMatrix) => ({
          set: drawn,
          ...placed,
          effects,
          modelMatrix,
        })),
        settings: { resolutionScale: engine.accuracy.resolutionScale },
      },
    };
  }

  async destroy(): Promise<void> {
    for (const engine of this.#engines.values()) (await engine).destroy();
  }
}

async function cloudOf(engine: SplatEngine, members: readonly FrameMember[]): Promise<MemberCloud> {
  let set: SplatSet<Harmonics> = randomSplats({
    count: MEMBER_COUNT,
    seed: SEED,
    shDegree: 1,
    logScales: [-3.5, -2],
    opacityLogits: [-2, 3],
  });
  for (const member of members) set = member.set?.(set) ?? set;
  const load = members.find((member) => member.load)?.load ?? (() => engine.add(set));
  const cloud = await load(engine, set);
  const edits = new SplatEdits(MEMBER_COUNT);
  for (const { follow } of members) await follow?.(cloud, edits);
  let drawn = set;
  for (const { asSplats } of members) drawn = asSplats?.(drawn) ?? drawn;
  return { cloud, drawn };
}
