import {
  ACCURACY_PRESETS,
  type Accuracy,
  type Camera,
  type FrameStatistics,
  type Harmonics,
  perspectiveCamera,
  resolveAccuracy,
  type SplatCloud,
  SplatEngine,
  type SplatSet,
  type SplatView,
} from '@websplatter/core';
import { compareViews } from '@websplatter/core/measure';
import { compareImages, renderReference } from '@websplatter/core/reference';
import { createNodeGpu } from '@websplatter/node';
import { watchDevice } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';

export const IS_FULL = process.env.WEBSPLATTER_FULL !== undefined;
const SIZE = IS_FULL ? { widthPx: 128, heightPx: 128 } : { widthPx: 64, heightPx: 64 };
/** Frames after the warm-up frame, whose time counts if there are none: software may take 1 s. */
const TIMED_FRAMES = IS_FULL ? 9 : 0;

/** Settings to draw with, the most exact first. */
const ROWS: Readonly<Record<string, Accuracy>> = {
  ...Object.fromEntries(Object.keys(ACCURACY_PRESETS).map((preset) => [preset, preset as Accuracy])),
  // By tiles, as `fast` is drawn: quads round every blended layer to 8 bits.
  'paper, f16 records, tiles': { preset: 'paper', recordPrecision: 'f16', rasterizer: 'tiles' },
};
/** No preset is more exact than those before it. `paper` has tests of its own below. */
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
  readonly timesMs: readonly number[];
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
      const firstMs = await drawTimed(drawn, { ...frame, accuracy });
      const { data } = await drawn.readPixels();
      const againstReference = await compareViews(drawn, reference);
      const raw = compareImages(data, float64.data, SIZE);
      const png = compareImages(data, float64.data, { ...SIZE, quantize: 'png' });
      const timesMs: number[] = [];
      for (let i = 0; i < TIMED_FRAMES; i++) timesMs.push(await drawTimed(drawn, { ...frame, accuracy }));
      rows[name] = {
        name,
        rawDb: raw.psnrDb,
        pngDb: png.psnrDb,
        maxError: raw.maxError,
        againstReferenceDb: againstReference.psnrDb,
        timesMs: TIMED_FRAMES > 0 ? timesMs.sort((a, b) => a - b) : [firstMs],
      };
    }
  } finally {
    for (const each of [reference, view]) each.destroy();
    cloud.destroy();
  }
  return rows;
}

/** Makes the cloud hold the planes that `accuracy` needs, beside those that it has. */
function hold(cloud: SplatCloud, accuracy: Accuracy): Promise<void> {
  const { geometryPrecision, shPrecision } = resolveAccuracy(accuracy);
  return cloud.hold({ geometryPrecision, shPrecision }).met;
}

/** Draws a frame, whether or not anything has changed, and returns its milliseconds. */
async function drawTimed(view: SplatView, frame: Parameters<SplatView['render']>[0]): Promise<number> {
  const statistics = new Promise<FrameStatistics>((resolve) => {
    view.onStatistics = resolve;
  });
  view.render({ ...frame, force: true });
  await view.whenDrawn();
  return (await statistics).timing.totalMs;
}

function report({ adapterLabel }: SplatEngine, scene: string, rows: Record<string, Row>): void {
  const decibels = (psnrDb: number) => (Number.isFinite(psnrDb) ? psnrDb.toFixed(1) : 'equal');
  const heading = [
    'preset',
    'raw dB',
    'png dB',
    'max, 8-bit steps',
    'dB to reference',
    'median ms',
    'least–most ms',
  ];
  const cells = Object.values(rows).map(({ name, rawDb, pngDb, maxError, againstReferenceDb, timesMs }) => [
    name,
    decibels(rawDb),
    decibels(pngDb),
    (255 * maxError).toFixed(3),
    decibels(againstReferenceDb),
    timesMs[(timesMs.length - 1) / 2].toFixed(1),
    `${timesMs[0].toFixed(1)}–${timesMs[timesMs.length - 1].toFixed(1)}`,
  ]);
  const widths = heading.map((title, i) => Math.max(title.length, ...cells.map((row) => row[i].length)));
  const lines = [heading, ...cells].map((row) => row.map((cell, i) => cell.padEnd(widths[i])).join('  '));
  const { widthPx, heightPx } = SIZE;
  console.info(
    [
      `${scene}, ${widthPx}×${heightPx}, ${adapterLabel}; time of ${TIMED_FRAMES > 0 ? `${TIMED_FRAMES} frames` : 'the first frame alone'}`,
      ...lines,
      '`paper` is not on the line from `reference` to `fast`: it mostly loses colours above 1, which a byte cannot hold.',
    ].join('\n'),
  );
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

/** Compares every preset with float64, prints its cost, and expects the list to be in order. */
export async function expectPresets(
  engine: SplatEngine,
  scene: string,
  set: SplatSet<Harmonics>,
  camera: Camera,
): Promise<void> {
  const rows = await measureRows(engine, set, camera);
  report(engine, `${scene}, ${set.count} splats`, rows);
  expectPresetsInOrder(rows);
}

/** The same for an object about 0, 2 across, y down. */
export function expectPresetsOfObject(
  engine: SplatEngine,
  scene: string,
  set: SplatSet<Harmonics>,
): Promise<void> {
  const [position, target, up] = [
    [1.6, -1, 2.2],
    [0, 0, 0],
    [0, -1, 0],
  ] as const;
  const camera = perspectiveCamera({ position, target, up, fovYDegrees: 50, aspect: 1 });
  return expectPresets(engine, scene, set, camera);
}
