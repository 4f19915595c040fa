/** Counts of an engine's work since it was created, to be compared by their differences. */
export interface EngineCounters {
  /** Clouds uploaded. */
  readonly uploads: number;
  /** Bytes of uploaded clouds, and of planes that were read again in a finer precision. */
  readonly uploadedBytes: number;
  readonly cloudsDestroyed: number;
  /** Frames whose splats were culled, projected and sorted; each runs the two compute passes. */
  readonly framesPrepared: number;
  /** Frames whose splats were drawn. */
  readonly framesDrawn: number;
  /** Pipelines compiled for this engine. Pipelines cached by earlier engines on the device are reused. */
  readonly pipelinesCompiled: number;
  /** Images and picks read back; measurements are not counted. */
  readonly readbacks: number;
}

/** `EngineCounters`, writable by the code that counts. */
export type Counting = { -readonly [Name in keyof EngineCounters]: number };

export function zeroCounters(): Counting {
  return {
    uploads: 0,
    uploadedBytes: 0,
    cloudsDestroyed: 0,
    framesPrepared: 0,
    framesDrawn: 0,
    pipelinesCompiled: 0,
    readbacks: 0,
  };
}
