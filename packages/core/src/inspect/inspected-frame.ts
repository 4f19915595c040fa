import { largestPlaneBytes } from '../clouds/cloud-planes.ts';
import { SplatCloud } from '../clouds/splat-cloud.ts';
import { type AccuracySettings, resolveAccuracy } from '../data/accuracy/accuracy.ts';
import type { Camera, Projection } from '../data/camera/camera.ts';
import { type CloudView, cloudView } from '../data/camera/cloud-view.ts';
import { type FrustumSide, frustumSides } from '../data/camera/frustum.ts';
import { clampCoefficient } from '../data/layout/half.ts';
import { identity4 } from '../data/math/mat4.ts';
import { dropNonFinite } from '../data/packing/drop-non-finite.ts';
import type { Harmonics, StoredHarmonics } from '../data/packing/harmonics.ts';
import { mortonOrder, permuteSplats } from '../data/packing/morton-order.ts';
import { type PackedCloud, packCloud } from '../data/packing/packed-cloud.ts';
import { productOf } from '../data/packing/rotation.ts';
import type { SortBy } from '../data/splats/sort-by.ts';
import type { ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import { MOTION_SLOT, MOTION_VALUES } from '../features/motion/splat-motion.data.ts';
import { FrameParts } from '../frame/frame.ts';
import { locateSplat } from '../frame/frame-pages.ts';
import { frameStages } from '../frame/frame-passes.ts';
import type { FrameBuffers } from '../frame/parts/frame-part.ts';
import { DEFAULT_TILE_BUDGET_BYTES } from '../frame/parts/pair-capacity.ts';
import { type CloudInstances, countInstances } from '../frame/plan/cloud-instances.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import { FramePlanner } from '../frame/plan/frame-planner.ts';
import { usesOf } from '../gpu/effects/cloud-effects.ts';
import type { EffectUse } from '../gpu/effects/effect.ts';
import { GpuMemory } from '../gpu/gpu-memory.ts';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { readTexture, type TextureImage } from '../gpu/read-texture.ts';
import type { EffectReference } from '../reference/effects/effect-reference.ts';
import { type ReferenceFunction, referencesOf } from '../reference/effects/references.ts';
import { unpackedColumns } from '../stages/repack/repack.reference.ts';
import { sortDeviceOf } from '../stages/sort/sort.ts';

/** The frame whose stages are read back. */
export interface InspectOptions {
  readonly clouds: readonly {
    readonly set: SplatSet<Harmonics>;
    readonly modelMatrix?: ArrayLike<number>;
    /** As in a frame request. The references ignore instances. */
    readonly instances?: CloudInstances;
    /** Multiplies every splat's opacity, 0…1; default 1. */
    readonly opacity?: number;
    /** As in a frame request. */
    readonly time?: number;
    /** As in a frame request. */
    readonly shDegree?: ShDegree;
    /** As in a frame request. */
    readonly effects?: readonly EffectUse[];
    /** Most splats per page, a multiple of CHUNK_SPLATS; default: all that fit a binding. */
    readonly splatsPerPage?: number;
  }[];
  /** References of effects from outside this package, by name. */
  readonly effectReferences?: Readonly<Record<string, ReferenceFunction>>;
  /** As in a frame request. */
  readonly sortBy?: SortBy;
  readonly camera: Camera;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Default: the preset `reference`, blended in rgba16float. */
  readonly accuracy?: Partial<AccuracySettings>;
  readonly dispatchRow?: number;
  /** Bits of sort keys; default: the accuracy's, 32. At 8 the single pass leaves the keys unchanged. */
  readonly keyBits?: number;
  /** Whether to use the shaders for narrow subgroups; default: as the device requires. */
  readonly isNarrow?: boolean;
  /** Default: one per device, with unchanged shaders. */
  readonly pipelines?: Pipelines;
  /** Whether splats are drawn once they are in order; default true. Without that, `image` has no values. */
  readonly isDrawn?: boolean;
}

/** A target that every device can blend: rgba32float is a feature. */
const DEFAULTS = { colorTarget: 'rgba16float' } as const;

/** A cloud of an inspected frame as the float64 references read it. */
export interface InspectedCloud {
  /** In storage order, with the values that the GPU unpacks. */
  readonly stored: SplatSet<StoredHarmonics>;
  readonly packed: PackedCloud;
  readonly view: CloudView;
  readonly effects: readonly EffectReference[];
  readonly dilationPx2: number;
  /** Degree of harmonics that is evaluated. */
  readonly shDegree: ShDegree;
  readonly planes: readonly FrustumSide[];
}

/** A frame's buffers after all of its stages, and inputs for references to compute the same. */
export class InspectedFrame {
  readonly plan: FramePlan;
  readonly parts: FrameParts;
  readonly clouds: readonly InspectedCloud[];
  readonly projection: Projection;
  readonly accuracy: AccuracySettings;
  /** The layer that splats were blended in: smaller than the image if the resolution is scaled. */
  readonly image: TextureImage;
  readonly #device: GPUDevice;
  readonly #memory: GpuMemory;
  readonly #words = new Map<string, Promise<Uint32Array<ArrayBuffer>>>();

  private constructor(
    device: GPUDevice,
    memory: GpuMemory,
    made: Pick<InspectedFrame, 'plan' | 'parts' | 'clouds' | 'projection' | 'accuracy' | 'image'>,
  ) {
    this.#device = device;
    this.#memory = memory;
    this.plan = made.plan;
    this.parts = made.parts;
    this.clouds = made.clouds;
    this.projection = made.projection;
    this.accuracy = made.accuracy;
    this.image = made.image;
  }

  static async draw(device: GPUDevice, options: InspectOptions): Promise<InspectedFrame> {
    const { camera, sortBy, widthPx, heightPx, isDrawn = true } = options;
    const accuracy = { ...resolveAccuracy('reference'), ...DEFAULTS, ...options.accuracy };
    const memory = new GpuMemory(device);
    const pipelines = options.pipelines ?? pipelinesOf(device);
    const sets = options.clouds.map(({ set }) => dropNonFinite(set));
    const packed = sets.map((set) => packCloud(set, accuracy));
    const instances = options.clouds.map(({ set: _, splatsPerPage, ...placed }, i) => ({
      cloud: SplatCloud.upload(memory, limitsFor(device, packed[i], splatsPerPage), packed[i], {
        name: `cloud ${i}`,
      }),
      ...placed,
    }));
    await Promise.all(instances.map(({ cloud }) => cloud.uploaded));
    const sortDevice = sortDeviceOf(device);
    const facts = {
      dispatchRow: options.dispatchRow ?? device.limits.maxComputeWorkgroupsPerDimension,
      sortDevice: { ...sortDevice, isNarrow: options.isNarrow ?? sortDevice.isNarrow },
    };
    const sizes = {
      visibleCapacity: instances.reduce((sum, each) => sum + each.cloud.count * countInstances(each), 0),
      keyBits: options.keyBits ?? accuracy.sortKeyBits,
      shortensKeys: accuracy.sortKeyBits < 32,
    };
    const planner = new FramePlanner(facts, { kind: 'image' }, () => true);
    const plan = planner.plan(
      { camera, clouds: instances, sortBy, widthPx, heightPx },
      { accuracy, depth: null, faster: 'quads', sizes },
    );
    const { projection } = plan;
    await pipelines.prepare(frameStages(plan.shape));
    const parts = new FrameParts({
      device,
      pipelines,
      memory,
      tileBudgetBytes: DEFAULT_TILE_BUDGET_BYTES,
    });
    parts.fit(plan);
    const encoder = device.createCommandEncoder();
    parts.record(encoder, parts.orderPasses);
    if (isDrawn) parts.record(encoder, parts.drawPasses({ kind: 'image' }));
    device.queue.submit([encoder.finish()]);
    const image = isDrawn
      ? await readTexture(device, parts.shared.resources.layer!)
      : { widthPx, heightPx, data: new Float32Array() };

    const clouds = options.clouds.map(({ modelMatrix = identity4() }, i) => {
      const { harmonics } = packed[i];
      const stored = {
        ...permuteSplats(sets[i], mortonOrder(sets[i].positions, sets[i].count)),
        // The stored harmonics: rounded, and without the bands that cannot be seen.
        harmonics,
      };
      const view = cloudView(camera.viewMatrix, modelMatrix, stored.origin, projection.isOrthographic);
      const { dilationPx2 } = plan.clouds[i];
      return {
        stored: accuracy.geometryPrecision === 'f32' ? float32Set(stored) : unpackedSet(stored, packed[i]),
        packed: packed[i],
        view,
        effects: referencesOf(
          usesOf(instances[i]),
          { modelMatrix, origin: stored.origin, viewMatrix: camera.viewMatrix, projection },
          options.effectReferences,
        ),
        shDegree: plan.shape.clouds[i].shDegree,
        dilationPx2,
        planes: frustumSides(view, projection, accuracy.alphaCutoff, dilationPx2),
      };
    });
    return new InspectedFrame(device, memory, { plan, parts, clouds, projection, accuracy, image });
  }

  destroy(): void {
    this.#memory.destroyAll();
  }

  /** Contents of one of the frame's buffers, read back once: no later frame changes the buffers. */
  words(name: keyof FrameBuffers): Promise<Uint32Array<ArrayBuffer>> {
    const words = this.#words.get(name) ?? readWords(this.#device, this.parts.shared.resources[name]);
    this.#words.set(name, words);
    return words;
  }

  /** Contents of the sort's keys or order: one per visible splat. */
  async sorted(name: 'keys' | 'order'): Promise<Uint32Array> {
    const words = await readWords(this.#device, this.parts.sort.sort[name]);
    return words.subarray(0, await this.visibleCount());
  }

  async visibleCount(): Promise<number> {
    return (await this.words('visibleCount'))[0];
  }

  /** Cloud and index in storage of splat `number`, counted through all chunks of the frame. */
  locate(number: number): { readonly cloud: InspectedCloud; readonly index: number } {
    const { cloudIndex, storedIndex } = locateSplat(this.parts.pages, number);
    return { cloud: this.clouds[cloudIndex], index: storedIndex };
  }
}

const pipelinesByDevice = new WeakMap<GPUDevice, Pipelines>();

/** Returns the `Pipelines` that all inspected frames of a device share. */
function pipelinesOf(device: GPUDevice): Pipelines {
  let pipelines = pipelinesByDevice.get(device);
  if (!pipelines) {
    pipelines = new Pipelines(device);
    pipelinesByDevice.set(device, pipelines);
  }
  return pipelines;
}

/** Limits that cut a cloud into pages of `splatsPerPage`; the device's own if it is undefined. */
function limitsFor(
  device: GPUDevice,
  { harmonics }: PackedCloud,
  splatsPerPage: number | undefined,
): GPUSupportedLimits {
  if (splatsPerPage === undefined) return device.limits;
  const bytes = largestPlaneBytes(harmonics.degree) * splatsPerPage;
  return { maxStorageBufferBindingSize: bytes, maxBufferSize: bytes } as GPUSupportedLimits;
}

/** Returns `stored` with values of float32 geometry: only coefficients have a smaller range. */
function float32Set(stored: SplatSet<StoredHarmonics>): SplatSet<StoredHarmonics> {
  return { ...stored, colorDc: stored.colorDc.map(clampCoefficient) };
}

/** Returns `stored` with the values that packing rounded it to. */
function unpackedSet(
  stored: SplatSet<StoredHarmonics>,
  { geometry }: PackedCloud,
): SplatSet<StoredHarmonics> {
  const unpacked = unpackedColumns(geometry, stored.count);
  const { motion } = stored;
  return {
    ...stored,
    ...unpacked,
    ...(motion && { motion: withTurnsOf(stored, motion, unpacked.rotations) }),
  };
}

/** Adapts turns to rounded rotations: the GPU keeps each in its splat's own frame, per length of its rotation. */
function withTurnsOf(
  { count, rotations }: SplatSet<StoredHarmonics>,
  motion: Float32Array,
  rounded: Float32Array,
): Float32Array {
  const adapted = motion.slice();
  for (let i = 0; i < count; i++) {
    const [w, x, y, z] = rotations.subarray(4 * i, 4 * i + 4);
    const length = Math.hypot(w, x, y, z);
    const inverse = length > 0 ? [w, -x, -y, -z].map((value) => value / length / length) : [1, 0, 0, 0];
    const at = i * MOTION_VALUES + MOTION_SLOT.turn;
    const own = productOf(inverse, motion.subarray(at, at + 4));
    adapted.set(productOf(rounded.subarray(4 * i, 4 * i + 4), own), at);
  }
  return adapted;
}
