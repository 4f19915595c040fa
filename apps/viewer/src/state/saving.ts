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
  /** Expected time until all are drawn, ms; null until it is known. */
  readonly leftMs: number | null;
}

/** A scene that is being written as a file. */
export interface SavingState {
  readonly fileName: string;
  readonly phase: 'read' | 'write' | 'cut';
  /** 0…1 of the phase; undefined if it is not known. */
  readonly part: number | undefined;
}

/** Files that are being written. */
export interface SavingsState {
  /** The scene that is being written as a splat file. */
  readonly saving: SavingState | null;
  /** The scene that is being written with all that was made of it. */
  readonly savingProject: SavingState | null;
  /** The scene that is being written as a web page. */
  readonly savingPage: SavingState | null;
  readonly picturing: PicturingState | null;
  readonly filming: FilmingState | null;
}

export const FIRST_SAVINGS: SavingsState = {
  saving: null,
  savingProject: null,
  savingPage: null,
  picturing: null,
  filming: null,
};
