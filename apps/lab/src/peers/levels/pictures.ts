import {
  type CloudInstance,
  type FixedDetail,
  type FrameRequest,
  perspectiveCamera,
  type SplatView,
} from '@websplatter/core';
import { antialias } from '@websplatter/core/effects';
import { compareImages } from '@websplatter/core/reference';
import type { SceneCamera } from '@websplatter/scenes';
import { NONE, type ReportPart } from '../runner/report.ts';
import type { Levels } from './levels.ts';

/** Pixels from the nearest distance. */
export const SIZE = { widthPx: 960, heightPx: 540 };
/** Distances of the camera as multiples of the nearest; pictures are as many times smaller. */
const DISTANCES = [1, 2, 4, 8];
/** Samples of a filtered picture along each side of a pixel. */
const SAMPLES = 4;
/** Widths of the low-pass filter that all levels are drawn with, px²: our default, and that of others. */
export const DILATIONS_PX2 = [0.1, 0.3];
/** Of a sample of a filtered picture, px² of its own: a fiftieth of a pixel's. */
const SAMPLE_DILATION_PX2 = 0.3;

type Seen = Pick<FrameRequest, 'camera' | 'widthPx' | 'heightPx'>;

/** Pictures of the whole scene that others are compared with. */
interface Truth extends Seen {
  /** As drawn with each of DILATIONS_PX2. */
  readonly full: ReadonlyMap<number, Float32Array>;
  /** The mean of 4×4 samples per pixel. */
  readonly filtered: Float32Array;
}

/** Means over the cameras: splats drawn, and PSNR against the whole scene, as drawn and filtered. */
type Pictured = Record<'drawn' | 'dB' | 'filtered dB', number>;

/** Draws the whole scene from each distance. */
export async function drawTruths(
  view: SplatView,
  whole: CloudInstance,
  place: SceneCamera,
): Promise<Truth[]> {
  const camera = perspectiveCamera({ ...place, aspect: SIZE.widthPx / SIZE.heightPx });
  const truths: Truth[] = [];
  for (const distance of DISTANCES) {
    const widthPx = Math.round(SIZE.widthPx / distance);
    const heightPx = Math.round(SIZE.heightPx / distance);
    const full = new Map<number, Float32Array>();
    for (const dilationPx2 of DILATIONS_PX2) {
      const { data } = await draw(view, whole, { camera, widthPx, heightPx }, 'full', dilationPx2);
      full.set(dilationPx2, data);
    }
    const samples = { camera, widthPx: SAMPLES * widthPx, heightPx: SAMPLES * heightPx };
    const { data } = await draw(view, whole, samples, 'full', SAMPLE_DILATION_PX2);
    const filtered = new Float32Array(4 * widthPx * heightPx);
    data.forEach((value, i) => {
      const x = Math.floor(((i >> 2) % samples.widthPx) / SAMPLES);
      const y = Math.floor((i >> 2) / samples.widthPx / SAMPLES);
      filtered[4 * (y * widthPx + x) + (i & 3)] += value / SAMPLES ** 2;
    });
    truths.push({ camera, widthPx, heightPx, full, filtered });
  }
  return truths;
}

/** Draws what `levels` choose for each camera with a filter; returns how near that is, by distance. */
export async function comparePictures(
  view: SplatView,
  truths: readonly (readonly Truth[])[],
  levels: Pick<Levels, 'choose'>,
  share: number,
  dilationPx2: number,
): Promise<Pictured[]> {
  const means = DISTANCES.map(() => ({ drawn: 0, dB: 0, 'filtered dB': 0 }));
  for (const ofCamera of truths) {
    const choice = await levels.choose(ofCamera[0].camera, share);
    for (const [i, truth] of ofCamera.entries()) {
      const { data, drawn } = await draw(view, choice.instance, truth, choice.detail, dilationPx2);
      const psnrDb = (expected: Float32Array) => compareImages(data, expected, truth).psnrDb;
      means[i].drawn += drawn / truths.length;
      means[i].dB += psnrDb(truth.full.get(dilationPx2)!) / truths.length;
      means[i]['filtered dB'] += psnrDb(truth.filtered) / truths.length;
    }
    choice.end?.();
  }
  return means;
}

async function draw(
  view: SplatView,
  instance: CloudInstance,
  seen: Seen,
  detail: FixedDetail,
  dilationPx2: number,
) {
  const clouds = [{ ...instance, effects: [...(instance.effects ?? []), antialias({ dilationPx2 })] }];
  let drawn = 0;
  // While shaders for cuts compile, a view may draw and count all splats.
  for (let frame = 0; frame < 2; frame++) {
    const counted = new Promise<number>((resolve) => {
      view.onStatistics = ({ visibleSplats }) => resolve(visibleSplats);
    });
    view.render({ ...seen, clouds, detail, accuracy: 'reference', force: true });
    await view.whenDrawn();
    drawn = await counted;
  }
  return { data: (await view.readPixels()).data, drawn };
}

/** Times and pictures of one project's levels. */
export interface Measured extends Pick<Levels, 'name' | 'buildMs'> {
  readonly ofShares: readonly {
    readonly share: number;
    /** Null if nothing is chosen or timed. */
    readonly choiceMs: number | null;
    /** By filter, px², and distance. */
    readonly pictures: ReadonlyMap<number, readonly Pictured[]>;
  }[];
}

/** Columns of pictures, and their digits. */
const COLUMNS = { drawn: 0, dB: 1, 'filtered dB': 1 };

/** A table of times and one of pictures, as Markdown that can also be read as it is. */
export function measuredTables(measured: readonly Measured[]): ReportPart[] {
  const shares = measured[0].ofShares.map(({ share }) => `${Math.round(100 * share)} %`);
  const columns = Object.entries(COLUMNS) as [keyof Pictured, number][];
  const times = measured.map(({ name, buildMs, ofShares }) => [
    name,
    buildMs.map((ms) => (ms / 1000).toFixed(2)).join(', '),
    ...ofShares.map(({ choiceMs }) => choiceMs?.toFixed(3) ?? NONE),
  ]);
  const pictures = shares.flatMap((share, i) =>
    measured.flatMap(({ name, ofShares }) =>
      Array.from(ofShares[i].pictures, ([dilationPx2, pictures]) => {
        const cells = columns.map(([of, digits]) => pictures.map((each) => each[of].toFixed(digits)));
        return [name, share, String(dilationPx2), ...cells.flat()];
      }),
    ),
  );
  const distances = columns.flatMap(([of]) => DISTANCES.map((distance) => `${of}, ${distance}×`));
  const choosing = shares.map((share) => `choosing ${share}, ms`);
  return [
    { heading: 'Times', rows: [['levels', 'building, s', ...choosing], ...times], notes: [] },
    { heading: 'Pictures', rows: [['levels', 'share', 'px²', ...distances], ...pictures], notes: [] },
  ];
}
