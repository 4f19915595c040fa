import {
  ACCURACY_PRESETS,
  type Accuracy,
  type Camera,
  type Harmonics,
  perspectiveCamera,
  resolveAccuracy,
  type SplatCloud,
  SplatEngine,
  type SplatSet,
} from '@websplatter/core';
import { compareViews } from '@websplatter/core/measure';
import { compareImages, renderReference } from '@websplatter/core/reference';
import { createNodeGpu } from '@websplatter/node';
import { watchDevice } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';

export const IS_FULL = process.env.WEBSPLATTER_FULL !== undefined;
const SIZE = IS_FULL ? { widthPx: 128, heightPx: 128 } : { widthPx: 64, heightPx: 64 };

/** Settings to draw with, the most exact first. */
const ROWS: Readonly<Record<string, Accuracy>> = {
  ...Object.fromEntries(Object.keys(ACCURACY_PRESETS).map((preset) => [preset, preset as Accuracy])),
  // By tiles, as `fast` is drawn: quads round every blended layer to 8 bits.
  'paper, f16 records, tiles': { preset: 'paper', recordPrecision: 'f16', rasterizer: 'tiles' },
};
/** Presets in order of falling accuracy. `paper` has its own tests below. */
const MOST_EXACT_FIRST = ['reference', 'high', 'balanced', 'fast'];

export async function referenceEngine(): Promise<SplatEngine> {
  const { gpu, adapter } = await createNodeGpu();
  const engine = await SplatEngine.create({ gpu, adapter, accuracy: 'reference' });
  watchDevice(engine.device);
  return engine;
}

interface Row {
  readonly name: string;
  /** Error against float64: of the values as they are, and of values rounded to 8 bits. */
  readonly rawDb: number;
  readonly pngDb: number;
  readonly maxError: number;
  /** Error against the preset `reference` on this GPU, computed on the GPU. */
  readonly againstReferenceDb: number;
}

async function measureRows(
  engine: SplatEngine,
  set: SplatSet<Harmonics>,
  camera: Camera,
): Promise<Record<string, Row>> {
  const float64 = renderReference({ clouds: [{ set }], camera, ...SIZE });
  expect(float64.visibleSplats).toBeGreaterThan(1000);
  const cloud = engine.add(set);
  const [reference, view] = [engine.createView(), engine.createView()];
  const frame = { camera, clouds: [{ cloud }], ...SIZE };
  const rows: Record<string, Row> = {};
  try {
    for (const [name, accuracy] of Object.entries(ROWS)) {
      const drawn = name === 'reference' ? reference : view;
      await hold(cloud, accuracy);
      drawn.render({ ...frame, accuracy });
      const { data } = await drawn.readPixels();
      const againstReference = await compareViews(drawn, reference);
      const raw = compareImages(data, float64.data, SIZE);
      const png = compareImages(data, float64.data, { ...SIZE, quantize: 'png' });
      rows[name] = {
        name,
        rawDb: raw.psnrDb,
        pngDb: png.psnrDb,
        maxError: raw.maxError,
        againstReferenceDb: againstReference.psnrDb,
      };
    }
  } finally {
    for (const each of [reference, view]) each.destroy();
    cloud.destroy();
  }
  return rows;
}

/** Makes the cloud's planes for `accuracy`, in addition to its present ones. */
function hold(cloud: SplatCloud, accuracy: Accuracy): Promise<void> {
  const { geometryPrecision, shPrecision } = resolveAccuracy(accuracy);
  return cloud.hold({ geometryPrecision, shPrecision }).met;
}

function expectPresetsInOrder(rows: Record<string, Row>): void {
  const { reference, balanced, fast, paper } = rows;
  expect(reference.pngDb).toBeGreaterThanOrEqual(58);
  expect(reference.rawDb).toBeGreaterThanOrEqual(70);
  expect(balanced.rawDb).toBeGreaterThanOrEqual(45);
  for (const [i, name] of MOST_EXACT_FIRST.entries()) {
    if (i === 0) continue;
    const [finer, coarser] = [rows[MOST_EXACT_FIRST[i - 1]], rows[name]];
    expect(finer.rawDb, `${finer.name} against ${name}`).toBeGreaterThanOrEqual(coarser.rawDb);
    expect(finer.againstReferenceDb, `${finer.name} against ${name}`).toBeGreaterThanOrEqual(
      coarser.againstReferenceDb,
    );
  }
  // `paper` may lie on either side of `fast`, only because of its records: wider ones make it as
  // exact. It blends more faint layers than `fast` does, and adapters round each to 8 bits in their
  // own way: one loses 0.15 dB.
  expect(paper.rawDb).toBeGreaterThan(35);
  expect(rows['paper, f16 records, tiles'].rawDb).toBeGreaterThanOrEqual(paper.rawDb);
  expect(rows['paper, f16 records, tiles'].rawDb).toBeGreaterThan(fast.rawDb - 0.5);
}

/** Compares every preset with float64, and expects the list to be in order. */
export async function expectPresets(
  engine: SplatEngine,
  set: SplatSet<Harmonics>,
  camera: Camera,
): Promise<void> {
  expectPresetsInOrder(await measureRows(engine, set, camera));
}

/** The same for an object about 0, 2 across, y down. */
export function expectPresetsOfObject(engine: SplatEngine, set: SplatSet<Harmonics>): Promise<void> {
  const [position, target, up] = [
    [1.6, -1, 2.2],
    [0, 0, 0],
    [0, -1, 0],
  ] as const;
  const camera = perspectiveCamera({ position, target, up, fovYDegrees: 50, aspect: 1 });
  return expectPresets(engine, set, camera);
}
