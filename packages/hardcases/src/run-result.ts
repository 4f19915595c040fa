import type { AccuracyPreset, DropCounts } from '@websplatter/core';
import type { FieldError, RecordField } from '@websplatter/core/inspect';
import type { HardCaseGroup } from './hard-case.ts';

/** A picture must be this close to float64 at preset `reference`, dB on raw values over black. */
export const MIN_REFERENCE_PSNR_DB = 55;

/** A field's error that is largest for its bound, and where it was found. */
export interface StageError extends FieldError<RecordField> {
  readonly camera: string;
  readonly preset: AccuracyPreset;
}

type StageErrors = Partial<Record<AccuracyPreset, Partial<Record<RecordField, StageError>>>>;

/** How far a case's pictures at one preset are from float64: the worst of its cameras. */
export interface ImageResult {
  readonly camera: string;
  /** Infinity where the pictures are equal, or clamp to the same. */
  readonly psnrDb: number;
  /** Largest absolute error of any channel, 0…1. */
  readonly maxError: number;
  /** What `psnrDb` had to reach; null where it is only reported. */
  readonly minPsnrDb: number | null;
}

/** What became of one case, as plain data. */
export interface HardCaseResult {
  readonly name: string;
  readonly group: HardCaseGroup;
  readonly verdict: 'pass' | 'fail';
  /** One line each: case, camera, preset, splat, expected and got, as far as they apply. */
  readonly failures: readonly string[];
  /** Per preset and field of a splat's record the worst error; empty where no splat is drawn. */
  readonly stages: StageErrors;
  /**
   * The worst of `stages` at preset `reference`, or at any where it is beyond its bound: rounding to float16 takes half
   * of its bound in every picture, and would hide what float32 does.
   */
  readonly worstStage: StageError | null;
  /** Splats so close to a threshold that rounding may decide, over all cameras. */
  readonly unsureSplats: number;
  readonly images: Partial<Readonly<Record<AccuracyPreset, ImageResult>>>;
  /** Splats that were left out before the GPU, by reason. */
  readonly dropped: DropCounts;
  readonly elapsedMs: number;
}

/** Collects what is found out about one case. */
export class ResultBuilder {
  readonly failures: string[] = [];
  readonly #stages: StageErrors = {};
  readonly #images: Partial<Record<AccuracyPreset, ImageResult>> = {};
  readonly #startMs = performance.now();
  unsureSplats = 0;
  dropped: DropCounts = {};

  /** @param where case, and camera and preset where they apply. */
  fail(where: readonly string[], what: string): void {
    this.failures.push(`${where.join(', ')}: ${what}`);
  }

  addStage(error: StageError): void {
    const ofPreset = this.#stages[error.preset] ?? {};
    this.#stages[error.preset] = ofPreset;
    if (error.ratio >= (ofPreset[error.field]?.ratio ?? 0)) ofPreset[error.field] = error;
  }

  addImage(preset: AccuracyPreset, image: ImageResult): void {
    const worst = this.#images[preset];
    if (!worst || image.psnrDb < worst.psnrDb) {
      this.#images[preset] = { ...image, maxError: Math.max(image.maxError, worst?.maxError ?? 0) };
    } else if (image.maxError > worst.maxError) {
      this.#images[preset] = { ...worst, maxError: image.maxError };
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
