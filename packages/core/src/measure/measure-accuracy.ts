import {
  ACCURACY_SETTINGS,
  type Accuracy,
  type AccuracySettings,
  DEFAULT_ACCURACY,
  type FrameRasterizer,
} from '../data/accuracy/accuracy.ts';
import type { Camera } from '../data/camera/camera.ts';
import { DestroyedError, InvalidArgumentError, SplatSourceError } from '../data/errors.ts';
import { checkKind, given, wrongArgument } from '../data/given.ts';
import { callListener } from '../data/listeners.ts';
import type { CloudPrecision } from '../data/packing/precision.ts';
import { checkDetail, type Detail, type FixedDetail, isFixedDetail } from '../frame/plan/detail.ts';
import type { CloudInstance, FrameRequest } from '../frame/plan/frame-request.ts';
import type { FrameStatistics, StageTimings } from '../gpu/timing/frame-statistics.ts';
import type { ImageDifference } from '../stages/measure/measure.reference.ts';
import {
  type Candidate,
  combined,
  detailCandidates,
  type SettingName,
  singleCandidates,
} from './candidates.ts';
import { checkMeasured } from './check-options.ts';
import { combineChanges, type FirstLook, MAX_COMBINATIONS } from './combine-changes.ts';
import { NonFiniteImageError } from './compare-textures.ts';
import { compareViews } from './compare-views.ts';
import { leasePlanes } from './lease-planes.ts';
import type { MeasuredEngine, MeasuredView } from './measured-engine.ts';
import { clockNotes, drawMeasured, withView } from './measured-frames.ts';
import { paretoFront } from './pareto-front.ts';
import { CROPS, drawSupersampled, type SupersampledPicture } from './supersampled-picture.ts';
import { type TimeSpread, timeSpread } from './time-spread.ts';

/** Scene and settings of `measureAccuracy`. */
export interface MeasureAccuracyOptions {
  /**
   * The clouds to draw, in a frame's order. Views may show them at the same time: measuring draws
   * its own frames.
   */
  readonly clouds: readonly CloudInstance[];
  /** At least one. The worst of several counts: the largest error, and the time of the slowest. */
  readonly cameras: readonly Camera[];
  /** Whole numbers from 1, pixels. */
  readonly widthPx: number;
  readonly heightPx: number;
  /**
   * Sort key of splats, as in `FrameRequest`: use the key of the frames that you will draw. Default
   * `auto`.
   */
  readonly sortBy?: FrameRequest['sortBy'];
  /** As in a frame request: settings are compared at this detail. */
  readonly detail?: Detail;
  /**
   * Further details to measure, each with the settings of `base`; default none. Example:
   * `DETAIL_SHARES.map((maxShare) => ({ maxShare }))`. Errors are against the full scene, so `detail`
   * must be `full`. Each point then also has `filteredPsnrDb`. Clouds get levels of detail, and keep
   * them.
   */
  readonly details?: readonly FixedDetail[];
  /** Settings that are changed one at a time; default `balanced`. */
  readonly base?: Accuracy;
  /** Names of the settings to change, one at a time; default all. None: the base and presets alone. */
  readonly settings?: readonly string[];
  /** Whether to measure the paper's ablations too; default true. */
  readonly ablations?: boolean;
  /** Whether to also combine changes that pay; default true. */
  readonly combinations?: boolean;
  /**
   * Measured frames per point and camera, default 15. Fewer than 6 give no 95 % interval: it then
   * spans all values.
   */
  readonly frames?: number;
  /** Ends the measurement: it rejects with the signal's reason and frees its memory. */
  readonly signal?: AbortSignal;
  /** Called after each step. The last report, just before the table, has all steps done. */
  readonly onProgress?: (progress: MeasureProgress) => void;
  /**
   * Called with the points timed so far, whenever there are more: keep the last table if you may
   * cancel the measurement. Times of few frames have wide intervals, and points may leave the front
   * as others are timed.
   */
  readonly onTable?: (table: AccuracyTable) => void;
}

/** How far a measurement has come. */
export interface MeasureProgress {
  /** Number of finished steps, each of about the same length; `total` may shrink. */
  readonly done: number;
  readonly total: number;
  /** Name of the current step, for people. */
  readonly label: string;
  /** Settings measured in the current step; undefined for other steps. */
  readonly point?: Pick<AccuracyPoint, 'name' | 'settings' | 'changed'>;
}

/** Cost of one set of settings at one detail, and the error of its image. */
export interface AccuracyPoint {
  /** A preset's name, or the differences from the base. */
  readonly name: string;
  readonly settings: AccuracySettings;
  /** Names of the settings that differ from the base. */
  readonly changed: readonly SettingName[];
  readonly detail: Detail;
  /** Splats and blobs drawn; of several cameras the most. */
  readonly splats: number;
  /**
   * Error against the reference, over black, values clamped to 0…1; `psnrDb` is Infinity for equal
   * images.
   */
  readonly error: ImageDifference;
  /**
   * PSNR against an antialiased picture of the full scene: reference settings, 4×4 samples per
   * pixel. The reference has one sample per pixel, so an image of fewer splats may have less
   * aliasing. Null if no `details` are measured.
   */
  readonly filteredPsnrDb: number | null;
  readonly timeMs: {
    /** Null if only the wall clock is known. */
    readonly preprocess: TimeSpread | null;
    readonly sort: TimeSpread | null;
    readonly rasterize: TimeSpread | null;
    readonly total: TimeSpread;
  };
  /** Rasterisers of the measured frames: both, if it changed or differs between cameras. */
  readonly rasterizers: readonly FrameRasterizer[];
  /** Whether no other point is both more accurate and faster, beyond the intervals of their times. */
  readonly isOnFront: boolean;
  /**
   * GPU memory of the clouds in these precisions, with levels if the detail needs them, and of one
   * view.
   */
  readonly bytes: number;
  readonly notes: readonly string[];
}

/** Result of `measureAccuracy`: error, time and memory of each setting tried. */
export interface AccuracyTable {
  /** The base first, then presets, single changes, combinations and details. */
  readonly points: readonly AccuracyPoint[];
  readonly base: AccuracySettings;
  /** Level of detail of the reference, and of all points except points of `details`. */
  readonly detail: Detail;
  /** The images behind the errors: preset `reference`, as far as device and clouds support it. */
  readonly reference: { readonly settings: AccuracySettings; readonly notes: readonly string[] };
  /** Notes about settings that were skipped, and about all points. */
  readonly notes: readonly string[];
  readonly timing: StageTimings['source'];
  /** Name of the adapter, for people. */
  readonly adapter: string;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Splats of all clouds. */
  readonly splats: number;
  /** Number of cameras. */
  readonly views: number;
  /** Measured frames per point and camera. */
  readonly frames: number;
  readonly elapsedMs: number;
}

const DEFAULT_FRAMES = 15;
/** Measured frames in a row, after an unmeasured one that makes the buffers and wakes the GPU. */
const FRAMES_PER_VISIT = 3;

/**
 * Measures cost and error of settings, for these clouds and cameras: milliseconds per stage, and
 * the error against the reference, computed on the GPU at full size.
 *
 * Points take turns, a few frames each (A B C, C B A, …), so that a GPU that warms up or is shared
 * slows all of them alike. One view at a time is measured, next to one that holds the reference:
 * the memory needed does not grow with the number of points. The clouds are leased in every
 * precision that is compared, which may require reading their sources again; afterwards they hold
 * the same planes as before. Other work of the page goes on between frames; its GPU work is
 * measured with the rest. With `details`, a picture per camera is held too, of 16 bytes per pixel.
 *
 * @throws InvalidArgumentError, GpuLimitError, DestroyedError, NonFiniteImageError of the
 * reference; SplatSourceError for a scene that streams; the reason of `signal`.
 * @example
 * const clouds = [{ cloud }];
 * const table = await measureAccuracy(engine, { clouds, cameras: [camera], widthPx, heightPx });
 * for (const { name, error, timeMs } of table.points)
 *   console.log(`${name}: ${error.psnrDb} dB in ${timeMs.total.median} ms`);
 */
export async function measureAccuracy(
  engine: MeasuredEngine,
  options: MeasureAccuracyOptions,
): Promise<AccuracyTable> {
  return measureThen(
    engine,
    options,
    (table) => table,
    () => null,
  );
}

/**
 * Returns how many steps `measureAccuracy` takes with these options, at most: `total` of its first
 * progress. Settings that the device or the clouds do not support take no steps. Steps take about
 * the same time, so one measurement predicts the time of another.
 *
 * @throws InvalidArgumentError for an unknown setting.
 * @example
 * const options = { clouds: [{ cloud }], cameras: [camera], widthPx, heightPx };
 * if (confirm(`Measure in ${countMeasureSteps(options)} steps?`)) await measureAccuracy(engine, options);
 */
export function countMeasureSteps(
  options: Pick<
    MeasureAccuracyOptions,
    'clouds' | 'cameras' | 'base' | 'settings' | 'ablations' | 'combinations' | 'details' | 'frames'
  >,
): number {
  return stepsOf(options, candidatesFor(options).length, options.details?.length ?? 0);
}

/** Steps for these presets, ablations, single changes and details, and the most for combinations. */
function stepsOf(
  { cameras, combinations = true, frames = DEFAULT_FRAMES }: Parameters<typeof countMeasureSteps>[0],
  candidates: number,
  details: number,
): number {
  const combining = combinations ? MAX_COMBINATIONS : 0;
  const supersampling = details > 0 ? CROPS * cameras.length : 0;
  return (candidates + details + combining) * stepsPerPoint(cameras.length, frames) + supersampling;
}

/** A comparison with the reference, and rounds of timing, for each camera. */
function stepsPerPoint(cameras: number, frames: number): number {
  return cameras * (1 + Math.ceil(frames / FRAMES_PER_VISIT));
}

function candidatesFor({
  clouds,
  base = DEFAULT_ACCURACY,
  settings,
  ablations,
  detail,
}: Parameters<typeof countMeasureSteps>[0] & Pick<MeasureAccuracyOptions, 'detail'>): Candidate[] {
  const withPalettes = clouds.every(({ cloud }) => cloud.facts.paletteEntries !== null);
  return singleCandidates(base, settings, ablations, withPalettes, detail);
}

/**
 * Measures as `measureAccuracy` does, but lets the clouds keep a precision.
 *
 * @param conclude makes the result from the table.
 * @param keep returns the precision whose planes the clouds keep after the measurement; null to
 * keep none.
 */
export async function measureThen<Result>(
  engine: MeasuredEngine,
  options: MeasureAccuracyOptions,
  conclude: (table: AccuracyTable) => Result,
  keep: (result: Result) => CloudPrecision | null,
): Promise<Result> {
  const { frames = DEFAULT_FRAMES, detail = 'full', details = [] } = given(options);
  checkMeasured(engine, options, { frames });
  checkKind('details', details, 'a list');
  for (const each of details) {
    checkDetail(each);
    if (!isFixedDetail(each))
      throw wrongArgument('details', each, "'full' or limits, such as { maxSplats: 1e6 }");
  }
  if (detail !== 'full' && details.length > 0) {
    const message = 'details are compared with the full scene; leave out detail, or details.';
    throw new InvalidArgumentError('details', message);
  }
  const { clouds, signal } = options;
  for (const { cloud } of clouds) {
    if (!cloud.stream) continue;
    const why = 'only parts of it are there, and pictures change as others come';
    throw new SplatSourceError(cloud.name, `${why}: measure the scene in another format.`);
  }
  const candidates = candidatesFor(options);
  const reference = engine.resolveAccuracy('reference');
  const planes = await leasePlanes(
    clouds.map(({ cloud }) => cloud),
    [reference.settings, ...candidates.map(({ settings }) => settings)],
    signal,
  );
  let kept: CloudPrecision | null = null;
  try {
    const result = conclude(await new Measurement(engine, options, candidates, planes.notes).run());
    kept = keep(result);
    return result;
  } finally {
    await planes.release(kept);
  }
}

/** One image of a candidate, or the worst of each kind. */
type Comparison = Pick<AccuracyPoint, 'error' | 'filteredPsnrDb' | 'splats' | 'bytes' | 'notes'>;

/** A candidate and its measurements so far. */
interface Measured extends Comparison {
  readonly candidate: Candidate;
  /** Per camera. */
  readonly frames: FrameStatistics[][];
}

class Measurement {
  readonly #engine: MeasuredEngine;
  readonly #options: MeasureAccuracyOptions;
  readonly #frames: number;
  readonly #reference: AccuracyTable['reference'];
  readonly #candidates: readonly Candidate[];
  readonly #notes: string[];
  /** Antialiased pictures of the full scene, per camera; empty if no `details` are measured. */
  readonly #pictures: SupersampledPicture[] = [];
  readonly #startedMs = performance.now();
  #done = 0;
  #total = 0;
  /** Points to measure; grows when combinations are chosen. */
  #count = 0;

  constructor(
    engine: MeasuredEngine,
    options: MeasureAccuracyOptions,
    candidates: readonly Candidate[],
    notes: readonly string[],
  ) {
    this.#engine = engine;
    this.#options = options;
    this.#candidates = candidates;
    this.#notes = [...notes];
    this.#frames = options.frames ?? DEFAULT_FRAMES;
    const { settings, notices } = engine.resolveAccuracy('reference');
    this.#reference = { settings, notes: [...notices, ...this.#planeNotes(settings)] };
  }

  async run(): Promise<AccuracyTable> {
    try {
      const table = await this.#measure();
      this.#total = this.#done;
      this.#step('Measured');
      return table;
    } finally {
      for (const picture of this.#pictures) picture.destroy();
    }
  }

  async #measure(): Promise<AccuracyTable> {
    const { cameras, base = DEFAULT_ACCURACY, details = [], onTable } = this.#options;
    const withCombinations = this.#options.combinations ?? true;
    const candidates = this.#candidates.filter((each) => this.#isPossible(each));
    const withLevels = details.length > 0 && (await this.#haveLevels());
    const ofDetails = withLevels ? detailCandidates(base, details) : [];
    this.#total = stepsOf(this.#options, candidates.length, ofDetails.length);

    if (ofDetails.length > 0) await this.#drawPictures();
    const [firstFrames, ...rounds] = visits(this.#frames);
    const measured: Measured[] = [];
    this.#count = candidates.length + ofDetails.length;
    await this.#begin(candidates, firstFrames, measured);
    const more = withCombinations ? combinationsOf(measured) : [];
    if (withCombinations)
      this.#total -= (MAX_COMBINATIONS - more.length) * stepsPerPoint(cameras.length, this.#frames);
    this.#count += more.length;
    await this.#begin([...more, ...ofDetails], firstFrames, measured);
    for (const [round, frames] of rounds.entries()) {
      // Every other round runs backwards, so that late points of one round are early in the next.
      const order = round % 2 === 0 ? [...measured].reverse() : measured;
      for (const each of order) {
        await this.#visit(each, frames, `Timing ${each.candidate.name} again`);
        callListener(onTable, this.#tableOf(measured));
      }
    }
    return this.#tableOf(measured);
  }

  #tableOf(measured: readonly Measured[]): AccuracyTable {
    const engine = this.#engine;
    const { clouds, cameras, widthPx, heightPx, detail = 'full' } = this.#options;
    const sources = measured.flatMap(({ frames }) => frames.flat().map(({ timing }) => timing));
    return {
      points: toPoints(measured),
      base: this.#candidates[0].settings,
      detail,
      reference: this.#reference,
      notes: [...this.#notes, ...clockNotes(sources)],
      timing: sources[0].source,
      adapter: engine.adapterLabel,
      widthPx,
      heightPx,
      splats: clouds.reduce((sum, { cloud }) => sum + cloud.count, 0),
      views: cameras.length,
      frames: this.#frames,
      elapsedMs: performance.now() - this.#startedMs,
    };
  }

  /** Whether device and clouds support the candidate's change; if not, adds a note with the reason. */
  #isPossible({ name, settings, changed }: Candidate): boolean {
    const leaveOut = (why: string) => {
      this.#notes.push(`${name} is left out: ${why}`);
      return false;
    };
    const possible = this.#engine.resolveAccuracy(settings);
    const isSingle = changed.length === 1;
    if (isSingle && possible.settings !== settings) return leaveOut(possible.notices.join(' '));
    if (isSingle && ACCURACY_SETTINGS[changed[0]].change === 'plane') {
      const [note] = this.#planeNotes(settings);
      if (note !== undefined) return leaveOut(note);
    }
    return true;
  }

  /** Makes the levels of all clouds; adds a note if a cloud cannot have them. */
  async #haveLevels(): Promise<boolean> {
    const { clouds, signal } = this.#options;
    for (const { cloud } of clouds) {
      try {
        await cloud.makeLevels();
      } catch (error) {
        if (error instanceof DestroyedError) throw error;
        this.#notes.push(`Less than full detail is left out: ${(error as Error).message}`);
        return false;
      }
      signal?.throwIfAborted();
    }
    return true;
  }

  async #drawPictures(): Promise<void> {
    for (const camera of this.#options.cameras) {
      const frame = this.#frame(camera, { settings: this.#reference.settings, detail: 'full' });
      const step = () => this.#step('Drawing the reference with 4×4 samples per pixel');
      this.#pictures.push(await drawSupersampled(this.#engine, frame, step));
    }
  }

  /**
   * Measures the worst error of each kind over all cameras, and the times of the first round, and
   * adds them to `measured`; notes and omits non-finite images.
   */
  async #begin(candidates: readonly Candidate[], frames: number, measured: Measured[]): Promise<void> {
    if (candidates.length === 0) return;
    const comparisons = new Map<Candidate, Comparison[]>(candidates.map((each) => [each, []]));
    const { cameras, detail = 'full', onTable } = this.#options;
    await withView(this.#engine, async (reference) => {
      for (const [index, camera] of cameras.entries()) {
        await drawMeasured(this.#engine, reference, {
          ...this.#frame(camera, { settings: this.#reference.settings, detail }),
          force: true,
        });
        for (const [candidate, found] of [...comparisons]) {
          const label = this.#place(measured.length, candidate);
          this.#step(label, candidate);
          try {
            found.push(await this.#compare(candidate, index, reference));
          } catch (error) {
            if (!(error instanceof NonFiniteImageError) || error.image !== 'actual') throw error;
            this.#notes.push(`${candidate.name} is left out: ${error.message}`);
            comparisons.delete(candidate);
            this.#count--;
            continue;
          }
          // Time right after the errors, so that the first table comes as early as possible.
          if (index < cameras.length - 1) continue;
          const point = { ...worstOf(found), candidate, frames: cameras.map(() => []) };
          await this.#visit(point, frames, label);
          measured.push(point);
          callListener(onTable, this.#tableOf(measured));
        }
      }
    });
  }

  /** `12 of 28: sortKeyBits 16`. */
  #place(index: number, { name }: Candidate): string {
    return `${index + 1} of ${this.#count}: ${name}`;
  }

  async #compare(candidate: Candidate, camera: number, reference: MeasuredView): Promise<Comparison> {
    const engine = this.#engine;
    const { settings, detail } = candidate;
    const { cameras, detail: ofReference = 'full' } = this.#options;
    const view = engine.createView();
    try {
      const { visibleSplats } = await drawMeasured(engine, view, this.#frame(cameras[camera], candidate));
      // Two images of the same settings may differ where a rasteriser is chosen for each view.
      const isReference = settings === this.#reference.settings && detail === ofReference;
      const compared = isReference ? reference : view;
      const error = await compareViews(compared, reference);
      const picture = this.#pictures[camera];
      const filtered = picture && (await compareViews(compared, picture));
      const notes = [
        ...engine.resolveAccuracy(settings).notices,
        ...this.#planeNotes(settings),
        ...(detail === ofReference ? [] : levelNotes(view)),
      ];
      const { totalBytes } = engine.memory();
      view.destroy();
      const viewBytes = totalBytes - engine.memory().totalBytes;
      const bytes = viewBytes + this.#cloudBytes(candidate);
      return { error, filteredPsnrDb: filtered?.psnrDb ?? null, splats: visibleSplats, bytes, notes };
    } finally {
      view.destroy();
    }
  }

  /** Draws a point a few times with every camera. */
  async #visit({ candidate, frames }: Measured, count: number, label: string): Promise<void> {
    await withView(this.#engine, async (view) => {
      for (const [index, camera] of this.#options.cameras.entries()) {
        this.#step(label, candidate);
        const frame = { ...this.#frame(camera, candidate), force: true };
        await drawMeasured(this.#engine, view, frame);
        for (let i = 0; i < count; i++) {
          this.#options.signal?.throwIfAborted();
          frames[index].push(await drawMeasured(this.#engine, view, frame));
        }
      }
    });
  }

  #frame(camera: Camera, { settings, detail }: Pick<Candidate, 'settings' | 'detail'>): FrameRequest {
    const { clouds, widthPx, heightPx, sortBy } = this.#options;
    return { camera, clouds, widthPx, heightPx, sortBy, detail, accuracy: settings };
  }

  /** Notes about precisions in `settings` that the clouds do not hold. */
  #planeNotes(settings: AccuracySettings): string[] {
    return this.#options.clouds.flatMap(({ cloud }) => {
      const { geometryPrecision, shPrecision } = cloud.pagesFor(settings);
      const instead = [];
      if (geometryPrecision !== settings.geometryPrecision) instead.push(`${geometryPrecision} geometry`);
      if (shPrecision !== settings.shPrecision) instead.push(`${shPrecision} spherical harmonics`);
      return instead.length === 0
        ? []
        : [`${cloud.name} is drawn with ${instead.join(' and ')}, the nearest it holds.`];
    });
  }

  /** Bytes of the planes and levels that a candidate is drawn with. */
  #cloudBytes({ settings, detail }: Candidate): number {
    const distinct = [...new Set(this.#options.clouds.map(({ cloud }) => cloud))];
    const planes = distinct.flatMap((cloud) => cloud.pagesFor(settings).pages);
    const levels = detail === 'full' ? [] : distinct.map((cloud) => cloud.levels);
    return (
      planes.reduce(
        (sum, { geometry, shRest, chunks }) => sum + geometry.size + chunks.size + (shRest?.size ?? 0),
        0,
      ) + levels.reduce((sum, each) => sum + (each?.bytes ?? 0), 0)
    );
  }

  #step(label: string, point?: Candidate): void {
    this.#options.signal?.throwIfAborted();
    const { onProgress } = this.#options;
    callListener(onProgress, { done: this.#done++, total: this.#total, label, point });
  }
}

/** Lists combinations of changes that pay, by the rough times of the first round. */
function combinationsOf(measured: readonly Measured[]): Candidate[] {
  const looks = measured.map(({ candidate, error, frames }): FirstLook => {
    const totals = frames.map((some) => timeSpread(some.map(({ timing }) => timing.totalMs)).median);
    return { candidate, psnrDb: error.psnrDb, totalMs: Math.max(...totals) };
  });
  const [base, ...others] = looks;
  const singles = others.filter(({ candidate }) => candidate.changed.length === 1);
  const known = new Set(measured.map(({ candidate }) => candidate.settings));
  return combineChanges(base, singles)
    .map((changes) => combined(base.candidate, changes))
    .filter(({ settings }) => !known.has(settings));
}

/** Returns the number of frames that each round measures, `frames` in all. */
function visits(frames: number): number[] {
  const full = Array<number>(Math.floor(frames / FRAMES_PER_VISIT)).fill(FRAMES_PER_VISIT);
  return frames % FRAMES_PER_VISIT === 0 ? full : [...full, frames % FRAMES_PER_VISIT];
}

/** Notes that explain why a view's last frame drew all splats although less detail was requested. */
function levelNotes(view: MeasuredView): string[] {
  const levels = view.effects().find(({ name }) => name === 'levels')!;
  return levels.isOn ? [] : [`All splats are drawn: ${levels.reason}.`];
}

function worstOf(comparisons: readonly Comparison[]): Comparison {
  const errors = comparisons.map(({ error }) => error);
  const filtered = comparisons.flatMap(({ filteredPsnrDb }) => filteredPsnrDb ?? []);
  return {
    error: {
      psnrDb: Math.min(...errors.map(({ psnrDb }) => psnrDb)),
      maxError: Math.max(...errors.map(({ maxError }) => maxError)),
      p999Error: Math.max(...errors.map(({ p999Error }) => p999Error)),
      ssim: Math.min(...errors.map(({ ssim }) => ssim)),
    },
    filteredPsnrDb: filtered.length > 0 ? Math.min(...filtered) : null,
    splats: Math.max(...comparisons.map(({ splats }) => splats)),
    bytes: Math.max(...comparisons.map(({ bytes }) => bytes)),
    notes: [...new Set(comparisons.flatMap(({ notes }) => notes))],
  };
}

function toPoints(measured: readonly Measured[]): AccuracyPoint[] {
  const points = measured.map(({ candidate, frames, ...worst }) => {
    const timeMs = slowestOf(frames.map((some) => some.map(({ timing }) => timing)));
    const rasterizers = [...new Set(frames.flat().map(({ rasterizer }) => rasterizer))];
    const { psnrDb } = worst.error;
    return { ...candidate, ...worst, timeMs, rasterizers, psnrDb, totalMs: timeMs.total };
  });
  const front = new Set(paretoFront(points));
  return points.map((point) => {
    const { psnrDb: _, totalMs: __, ...rest } = point;
    return { ...rest, isOnFront: front.has(point) };
  });
}

/** Returns the times of the slowest camera. */
function slowestOf(timings: readonly (readonly StageTimings[])[]): AccuracyPoint['timeMs'] {
  const spreads = timings.map((some) => {
    const spreadOf = (stage: 'preprocessMs' | 'sortMs' | 'rasterizeMs' | 'totalMs') =>
      timeSpread(some.map((one) => one[stage]));
    const hasStages = some.every(({ source }) => source === 'gpu-timestamps');
    return {
      preprocess: hasStages ? spreadOf('preprocessMs') : null,
      sort: hasStages ? spreadOf('sortMs') : null,
      rasterize: hasStages ? spreadOf('rasterizeMs') : null,
      total: spreadOf('totalMs'),
    };
  });
  return spreads.reduce((slowest, each) => (each.total.median > slowest.total.median ? each : slowest));
}
