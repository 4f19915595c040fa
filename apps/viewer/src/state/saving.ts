/** A picture that is being drawn as a file. */
export interface PicturingState {
  readonly fileName: string;
  /** 0…1. */
  readonly part: number;
}

/** A video that is being drawn as a file. */
export interface FilmingState {
  readonly fileName: string;
  readonly drawnFrames: number;
  readonly frames: number;
}

/** A scene that is being written as a file. */
export interface SavingState {
  readonly fileName: string;
  readonly phase: 'read' | 'write';
  /** 0…1 of the phase; undefined where that is not known. */
  readonly part: number | undefined;
}
