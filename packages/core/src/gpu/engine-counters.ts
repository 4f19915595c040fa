/** What an engine has done since it was made; numbers only grow. For tests and displays: their differences tell. */
export interface EngineCounters {
  /** Clouds uploaded. */
  readonly uploads: number;
  /** Bytes of those clouds, and of what was read again in a finer precision. */
  readonly uploadedBytes: number;
  readonly cloudsDestroyed: number;
  /** Frames whose splats were culled, projected and sorted: each runs the two compute passes. */
  readonly framesPrepared: number;
  /** Frames whose splats were drawn. */
  readonly framesDrawn: number;
  /** Pipelines compiled for this engine, not counting those that another one on the device had compiled already. */
  readonly pipelinesCompiled: number;
  /** Pictures and picks read back; measurements are not counted. */
  readonly readbacks: number;
}

/** The counters as those see them who count. */
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
