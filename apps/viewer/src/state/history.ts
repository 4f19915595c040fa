/** An undoable change of the scene. */
export interface Edit {
  /** What it changes, in lower case, as in "Undo crop". */
  readonly name: string;
  /** Memory that it holds, besides what the scene holds anyway; absent if that is next to nothing. */
  readonly bytes?: number;
  do(): void;
  undo(): void;
}

/** All edits around the present state, of whatever part of the scene. */
export interface HistoryState {
  /** Edits that can be taken back, the newest last. */
  readonly past: readonly Edit[];
  /** Edits that can be made again, the next one last. */
  readonly undone: readonly Edit[];
  /** What the newest edit belongs to, for example a drag; null for an edit of its own. */
  readonly gesture: unknown;
}

/** A scene without edits. */
export const NO_HISTORY: HistoryState = { past: [], undone: [], gesture: null };
