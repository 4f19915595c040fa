import { expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import type { Accuracy, AccuracyPreset } from '../data/accuracy/accuracy.ts';
import { type Camera, perspectiveCamera } from '../data/camera/camera.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { ShDegree, SplatSet } from '../data/splats/splat-set.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import type { SplatView } from '../views/splat-view.ts';

/** PSNR that each preset must reach against the float64 reference, dB on the target's values. */
export const MIN_PSNR_DB = { reference: 60, high: 50, balanced: 45 } satisfies Partial<
  Record<AccuracyPreset, number>
>;
type ComparedPreset = keyof typeof MIN_PSNR_DB;
const PRESETS = Object.keys(MIN_PSNR_DB) as ComparedPreset[];

export type PresetEngines = Record<ComparedPreset, SplatEngine>;

/** One engine per preset on one device, so that each pipeline is compiled once. */
export async function presetEngines(device: GPUDevice): Promise<PresetEngines> {
  const engines = {} as PresetEngines;
  for (const preset of PRESETS)
    engines[preset] = await SplatEngine.create({ device, accuracy: byTiles(preset) });
  return engines;
}

/** Images are compared bit for bit: their rasteriser must not follow from times. */
export function byTiles(preset: AccuracyPreset): Accuracy {
  return { preset, rasterizer: 'tiles' };
}

export interface Scene {
  readonly clouds: readonly {
    readonly set: SplatSet<Harmonics>;
    readonly modelMatrix?: ArrayLike<number>;
    readonly opacity?: number;
    readonly shDegree?: ShDegree;
  }[];
  readonly camera: Camera;
}

type Size = Pick<FrameRequest, 'widthPx' | 'heightPx'>;

export async function draw(view: SplatView, frame: FrameRequest): Promise<Float32Array> {
  view.render(frame);
  return (await view.readPixels()).data;
}

/** Draws `scene` with its own view, then frees everything. */
export async function drawAlone(
  engine: SplatEngine,
  { clouds, camera }: Scene,
  size: Size,
): Promise<Float32Array> {
  const view = engine.createView();
  const instances = clouds.map(({ set, ...placement }) => ({ cloud: engine.add(set), ...placement }));
  try {
    return await draw(view, { camera, clouds: instances, ...size });
  } finally {
    view.destroy();
    for (const { cloud } of instances) cloud.destroy();
  }
}

export async function expectPresetsAccurate(engines: PresetEngines, scene: Scene, size: Size): Promise<void> {
  const reference = renderReference({ ...scene, ...size });
  expect(reference.visibleSplats).toBeGreaterThan(20);
  for (const preset of PRESETS) {
    const image = await drawAlone(engines[preset], scene, size);
    const { psnrDb } = compareImages(image, reference.data, size);
    expect(psnrDb, preset).toBeGreaterThanOrEqual(MIN_PSNR_DB[preset]);
  }
}

/** The same for an object about 0, 2 across, y down. */
export function expectObjectAccurate(
  engines: PresetEngines,
  set: SplatSet<Harmonics>,
  sizePx = 256,
): Promise<void> {
  const camera = perspectiveCamera({
    // Positions in SPZ are whole steps: from a direction of small whole numbers, several splats
    // have exactly the same depth, and nothing decides their order.
    position: [1.618, -1.047, 2.236],
    target: [0, 0, 0],
    up: [0, -1, 0],
    fovYDegrees: 50,
    aspect: 1,
  });
  return expectPresetsAccurate(engines, { clouds: [{ set }], camera }, { widthPx: sizePx, heightPx: sizePx });
}
