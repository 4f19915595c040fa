import type { AccuracyPreset, DropCounts, FrameRasterizer } from '@websplatter/core';
import type { FieldError, RecordField } from '@websplatter/core/inspect';
import type { HardCaseGroup } from './hard-case.ts';

/** Least PSNR against float64 at preset `reference`, dB on raw values over black. */
export const MIN_REFERENCE_PSNR_DB = 55;

/** Each draws every image with a bound, and must keep it; the first draws images without one. */
export const CASE_RASTERIZERS: readonly FrameRasterizer[] = ['quads', 'tiles'];

/** A field's largest error in proportion to its bound, and where it was found. */
export interface StageError extends FieldError<RecordField> {
  readonly camera: string;
  readonly preset: AccuracyPreset;
}

type StageErrors = Partial<Record<AccuracyPreset, Partial<Record<RecordField, StageError>>>>;

/** Error of a case's images, of one preset and rasteriser, against float64: the worst camera's. */
export interface ImageResult {
  readonly camera: string;
  /** Infinity if the images are equal after clamping. */
  readonly psnrDb: number;
  /** Largest absolute error of any channel, 0…1. */
  readonly maxError: number;
  /** Least `psnrDb` demanded; null if it is only reported. */
  readonly minPsnrDb: number | null;
}

export type ImageResults = Partial<Readonly<Record<AccuracyPreset, ImageResult>>>;

/** Result of one case, as plain data. */
export interface HardCaseResult {
  readonly name: string;
  readonly group: HardCaseGroup;
  readonly verdict: 'pass' | 'fail';
  /** One line per failure: case, camera, preset, rasteriser, splat, expected and got, if any. */
  readonly failures: readonly string[];
  /** Worst error per preset and field of a splat's record; empty if no splat is drawn. */
  readonly stages: StageErrors;
  /**
   * The worst of `stages` at preset `reference`, or at any preset if it exceeds its bound. Others
   * do not count: rounding to float16 takes half of its bound in every frame, and would hide
   * float32's errors.
   */
  readonly worstStage: StageError | null;
  /** Number of splats, over all cameras, so close to a threshold that rounding may decide. */
  readonly unsureSplats: number;
  readonly images: Readonly<Record<FrameRasterizer, ImageResults>>;
  /** Splats dropped before the GPU, by reason. */
  readonly dropped: DropCounts;
  readonly elapsedMs: number;
}

/** Collects the findings about one case. */
export class ResultBuilder {
  readonly failures: string[] = [];
  readonly #stages: StageErrors = {};
  readonly #images: Record<FrameRasterizer, Partial<Record<AccuracyPreset, ImageResult>>> = {
    quads: {},
    tiles: {},
  };
  readonly #startMs = performance.now();
  unsureSplats = 0;
  dropped: DropCounts = {};

  /** @param where case, and camera, preset and rasteriser where they apply. */
  fail(where: readonly string[], what: string): void {
    this.failures.push(`${where.join(', ')}: ${what}`);
  }

  addStage(error: StageError): void {
    const ofPreset = this.#stages[error.preset] ?? {};
    this.#stages[error.preset] = ofPreset;
    if (error.ratio >= (ofPreset[error.field]?.ratio ?? 0)) ofPreset[error.field] = error;
  }

  addImage(preset: AccuracyPreset, rasterizer: FrameRasterizer, image: ImageResult): void {
    const images = this.#images[rasterizer];
    const worst = images[preset];
    if (!worst || image.psnrDb < worst.psnrDb) {
      images[preset] = { ...image, maxError: Math.max(image.maxError, worst?.maxError ?? 0) };
    } else if (image.maxError > worst.maxError) {
      images[preset] = { ...worst, maxError: image.maxError };
    }
  }

  build(name: string, group: HardCaseGroup): HardCaseResult {
    return {
      name,
      group,
      verdict: this.failures.length === 0 ? 'pass' : 'fail',
      failures: this.failures,
      stages: this.#stages,
      worstStage: worstOf(this.#stages),
      unsureSplats: this.unsureSplats,
      images: this.#images,
      dropped: this.dropped,
      elapsedMs: performance.now() - this.#startMs,
    };
  }
}

function worstOf(stages: StageErrors): StageError | null {
  const all = Object.values(stages).flatMap((ofPreset) => Object.values(ofPreset));
  const counted = all.filter(({ preset, ratio }) => preset === 'reference' || ratio > 1);
  return counted.reduce<StageError | null>(
    (worst, each) => (worst && worst.ratio >= each.ratio ? worst : each),
    null,
  );
}
