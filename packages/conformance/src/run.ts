import {
  type AccuracyPreset,
  adapterLabel,
  type CloudInstance,
  type FrameRasterizer,
  frameScene,
  isSoftwareAdapter,
  readSplats,
  SplatFileError,
} from '@websplatter/core';
import { orderFlaw, type ShaderMutation, sortKeys } from '@websplatter/core/inspect';
import { renderReference } from '@websplatter/core/reference';
import type {
  CameraProperty,
  DeviceCase,
  FirstCamera,
  FramingCase,
  HardCase,
  RefusedFileCase,
  SceneCase,
  SortCase,
} from './hard-case.ts';
import { type RunVariant, requestAdapter, WatchedDevice } from './run-device.ts';
import { COMPARED_PRESETS } from './run-images.ts';
import { CASE_RASTERIZERS, type HardCaseResult, ResultBuilder } from './run-result.ts';
import { readCloud, runScene } from './run-scene.ts';
import { truncatesHalves } from './truncates-halves.ts';

export interface HardCaseRunnerOptions {
  /** `navigator.gpu`, or another source of a fresh adapter per request, for one device each. */
  readonly gpu: Pick<GPU, 'requestAdapter'>;
  /**
   * Renders the images to compare with, default the float64 reference; for tests that errors are
   * noticed.
   */
  readonly renderReference?: typeof renderReference;
}

export interface HardCaseRunOptions {
  /** Width and height of images for cases that give no size; default 64. */
  readonly sizePx?: number;
  /** Default `COMPARED_PRESETS`. */
  readonly presets?: readonly AccuracyPreset[];
  /** Default `CASE_RASTERIZERS`. */
  readonly rasterizers?: readonly FrameRasterizer[];
  /**
   * Which images are drawn repeatedly, to find differences. `all`, the default: every preset and
   * rasteriser. `few`: only the first preset and rasteriser of cases with `identicalFrames`, at most
   * 20 times.
   */
  readonly repeats?: 'all' | 'few';
  /**
   * For a short run: the stages of each camera are checked in one of the ways of `STAGE_CHECKS`,
   * and its images with one rasteriser, in turns from camera to camera and from one number to the
   * next. Default: each camera is checked in all ways.
   */
  readonly turn?: number;
  /** Whether the rest is left out after a failure, for tests that there is one; default false. */
  readonly endsAtFailure?: boolean;
  /** A remedy of the shaders to switch off, for tests that the cases notice it. */
  readonly mutation?: ShaderMutation;
}

/** A case that takes longer is taken to hang. */
const CASE_LIMIT_MS = 60_000;
/** Features that an engine requests where the adapter has them. */
const ENGINE_FEATURES = [
  'timestamp-query',
  'float32-blendable',
  'core-features-and-limits',
] as GPUFeatureName[];

/** Runs hard cases on one GPU, one after the other, in Node and in browsers. */
export class HardCaseRunner {
  readonly adapterLabel: string;
  readonly isSoftware: boolean;
  /** Features of the device, in alphabetical order. */
  readonly features: readonly string[];
  /** Whether the GPU blends halves by truncation, which is measured. */
  readonly isTruncating: boolean;
  readonly #options: HardCaseRunnerOptions;
  #watched: WatchedDevice;
  #second: WatchedDevice | null = null;

  private constructor(options: HardCaseRunnerOptions, watched: WatchedDevice, isTruncating: boolean) {
    const { adapterInfo } = watched.device;
    this.#options = options;
    this.#watched = watched;
    this.adapterLabel = adapterLabel(adapterInfo);
    this.isSoftware = isSoftwareAdapter(adapterInfo);
    this.features = [...watched.device.features].sort();
    this.isTruncating = isTruncating;
  }

  /** @throws WebGpuUnavailableError if there is no adapter or no device. */
  static async create(options: HardCaseRunnerOptions): Promise<HardCaseRunner> {
    const watched = await WatchedDevice.request(options.gpu);
    try {
      return new HardCaseRunner(options, watched, await truncatesHalves(watched.device));
    } catch (error) {
      watched.destroy();
      throw error;
    }
  }

  /** Never rejects: a case that throws counts as failed. */
  async run(hardCase: HardCase, options: HardCaseRunOptions = {}): Promise<HardCaseResult> {
    const result = new ResultBuilder();
    const fail = (what: string) => result.fail([hardCase.name], what);
    try {
      if (this.#watched.isLost) {
        // The device was lost between two cases, which no case has reported.
        for (const error of await this.#watched.takeErrors()) fail(error);
        this.#watched = await WatchedDevice.request(this.#options.gpu);
      }
      await withinLimit(this.#runKind(hardCase, options, result));
    } catch (error) {
      fail(error instanceof Error ? `${error.name}: ${error.message}` : String(error));
      if (error instanceof CaseTimeoutError) this.#watched.destroy();
    }
    for (const error of await this.#watched.takeErrors()) fail(error);
    return result.build(hardCase.name, hardCase.group);
  }

  destroy(): void {
    this.#watched.destroy();
    this.#second?.destroy();
  }

  #runKind(hardCase: HardCase, options: HardCaseRunOptions, result: ResultBuilder): Promise<void> {
    switch (hardCase.kind) {
      case 'scene':
        return this.#runSceneOn(this.#watched, hardCase, options, result);
      case 'device':
        return this.#runDevice(hardCase, options, result);
      case 'sort':
        return this.#runSort(hardCase, options, result);
      case 'framing':
        return runFraming(hardCase, this.#watched, options.presets ?? COMPARED_PRESETS, result);
      case 'refused-file':
        return runRefusedFile(hardCase, result);
      case 'arithmetic':
        return runArithmetic(hardCase.name, hardCase.check, result);
    }
  }

  #runSceneOn(
    watched: WatchedDevice,
    hardCase: SceneCase | DeviceCase,
    options: HardCaseRunOptions,
    result: ResultBuilder,
  ): Promise<void> {
    const { sizePx = 64, presets = COMPARED_PRESETS, rasterizers = CASE_RASTERIZERS } = options;
    const { repeats = 'all', turn, endsAtFailure = false, mutation } = options;
    const variant: RunVariant = { maxWorkgroupsPerDimension: hardCase.maxWorkgroupsPerDimension, mutation };
    return runScene(
      hardCase,
      {
        watched,
        secondDevice: async () => {
          if (!this.#second || this.#second.isLost)
            this.#second = await WatchedDevice.request(this.#options.gpu);
          return this.#second;
        },
        variant,
        isTruncating: this.isTruncating,
        presets,
        rasterizers,
        sizePx,
        repeats,
        turn,
        endsAtFailure,
        renderReference: this.#options.renderReference ?? renderReference,
      },
      result,
    );
  }

  /** Runs a case on its own device, with default limits, without the features that it names. */
  async #runDevice(hardCase: DeviceCase, options: HardCaseRunOptions, result: ResultBuilder): Promise<void> {
    const adapter = await requestAdapter(this.#options.gpu);
    const requiredFeatures = ENGINE_FEATURES.filter(
      (feature) => adapter.features.has(feature) && !hardCase.without.includes(feature),
    );
    const watched = new WatchedDevice(
      await adapter.requestDevice({ label: hardCase.name, requiredFeatures }),
    );
    try {
      await this.#runSceneOn(watched, hardCase, options, result);
      for (const error of await watched.takeErrors()) result.fail([hardCase.name], error);
    } finally {
      watched.destroy();
    }
  }

  async #runSort(
    { name, keys, keyBits, maxWorkgroupsPerDimension }: SortCase,
    { mutation }: HardCaseRunOptions,
    result: ResultBuilder,
  ): Promise<void> {
    const variant = { maxWorkgroupsPerDimension, mutation };
    const watched = this.#watched;
    const given = keys();
    const row = watched.dispatchRow(variant);
    const order = await sortKeys(watched.device, watched.pipelines(variant), given, keyBits, row);
    const flaw = orderFlaw(given, order);
    if (flaw) result.fail([name, `${given.length} keys of ${keyBits} bits`], flaw);
  }
}

async function runRefusedFile({ name, file, code }: RefusedFileCase, result: ResultBuilder): Promise<void> {
  try {
    const { count } = await readSplats(file());
    result.fail([name], `got ${count} splats, expected SplatFileError ${code}`);
  } catch (error) {
    if (error instanceof SplatFileError && error.code === code) return;
    result.fail([name], `got ${error}, expected SplatFileError ${code}`);
  }
}

async function runArithmetic(name: string, check: () => string | null, result: ResultBuilder): Promise<void> {
  const wrong = check();
  if (wrong !== null) result.fail([name], wrong);
}

/** Finds the first camera of a case by the engine of each preset, as an application would. */
async function runFraming(
  hardCase: FramingCase,
  watched: WatchedDevice,
  presets: readonly AccuracyPreset[],
  result: ResultBuilder,
): Promise<void> {
  const sets = await Promise.all(hardCase.clouds().map(readCloud));
  for (const preset of presets) {
    const engine = await watched.engine(preset, {});
    const clouds: CloudInstance[] = [];
    try {
      for (const { set, modelMatrix } of sets) clouds.push({ cloud: engine.add(set), modelMatrix });
      const expected = hardCase.cameras[engine.accuracy.geometryPrecision];
      for (const flaw of cameraFlaws(expected, hardCase.expects, await frameScene(clouds)))
        result.fail([hardCase.name, preset], flaw);
    } finally {
      for (const { cloud } of clouds) cloud.destroy();
    }
  }
}

/**
 * Lists the flaws of a camera, null if none was found: a bit that is not the expected one's, and
 * properties that it lacks. Without the latter it is another camera, but a good one.
 */
export function cameraFlaws(
  expected: FirstCamera,
  properties: readonly CameraProperty[],
  camera: FirstCamera | null,
): string[] {
  if (!camera) return ['found no camera'];
  const [got, wanted] = [allDigits(camera), allDigits(expected)];
  return [
    ...(got === wanted ? [] : [`got ${got}, expected ${wanted}`]),
    ...properties.filter(({ holds }) => !holds(camera)).map(({ what }) => `expected that ${what}`),
  ];
}

/** A camera as the catalogue has it: texts are equal where all bits are. */
function allDigits({ kind, position, target, up }: FirstCamera): string {
  // JavaScript prints the fewest digits that lead back to the same float64, but loses the sign of −0.
  const list = (values: readonly number[]) =>
    `[${values.map((value) => (Object.is(value, -0) ? '-0' : value)).join(', ')}]`;
  return `{ kind: '${kind}', position: ${list(position)}, target: ${list(target)}, up: ${list(up)} }`;
}

class CaseTimeoutError extends Error {
  override readonly name = 'CaseTimeoutError';
}

async function withinLimit(work: Promise<void>): Promise<void> {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const limit = new Promise<never>((_, reject) => {
    const error = new CaseTimeoutError(`not done after ${CASE_LIMIT_MS / 1000} s; the device is replaced`);
    timer = setTimeout(() => reject(error), CASE_LIMIT_MS);
  });
  try {
    await Promise.race([work, limit]);
  } finally {
    clearTimeout(timer);
  }
}
