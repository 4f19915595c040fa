import type { Camera, CloudInstance, FixedDetail } from '@websplatter/core';

/** Levels that one project has made of a scene. */
export interface Levels {
  readonly name: string;
  /** One time for each build, or for each file. */
  readonly buildMs: readonly number[];
  /** Chooses at most a share of the splats. */
  choose(camera: Camera, share: number): Promise<Choice>;
  /** Median time of choosing by each of `cameras`; null if nothing is chosen or timed. */
  choiceMs(cameras: readonly Camera[], share: number): Promise<number | null>;
}

/** A cloud and its detail, to be drawn in place of a scene. */
export interface Choice {
  readonly instance: CloudInstance;
  readonly detail: FixedDetail;
  end?(): void;
}
