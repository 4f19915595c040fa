/** An undoable change. `do` and `undo` store the given steps in the same update as the change. */
export interface Edit {
  readonly name: string;
  do(steps: Steps): void;
  undo(steps: Steps): void;
}

/** Edits around the present state, which a slice of the store holds for the buttons. */
export interface Steps {
  /** Edits that `undo` takes back, the newest last. */
  readonly past: readonly Edit[];
  /** Edits that `redo` makes again, the next one last. */
  readonly undone: readonly Edit[];
}

/** Undoes and redoes edits. */
export class History {
  readonly #steps: () => Steps;
  readonly #most: number;
  #gesture: unknown = null;

  /**
   * @param steps the steps that the edits stored last.
   * @param most number of edits that can be undone, at least 1; older ones are forgotten.
   */
  constructor(steps: () => Steps, most: number) {
    this.#steps = steps;
    this.#most = most;
  }

  /** Whether an edit of `gesture` joins the newest edit. */
  continues(gesture: unknown): boolean {
    return gesture !== null && gesture === this.#gesture && this.#steps().past.length > 0;
  }

  /**
   * Makes an edit.
   *
   * @param gesture successive edits of one gesture are undone together; null for an edit of its own.
   */
  take(edit: Edit, gesture: unknown = null): void {
    const { past } = this.#steps();
    const last = this.continues(gesture) ? past.at(-1) : undefined;
    const step = last ? { ...edit, undo: last.undo } : edit;
    const steps = [...(last ? past.slice(0, -1) : past), step].slice(-this.#most);
    edit.do({ past: steps, undone: [] });
    this.#gesture = gesture;
  }

  undo(): void {
    const { past, undone } = this.#steps();
    const edit = past.at(-1);
    this.#gesture = null;
    edit?.undo({ past: past.slice(0, -1), undone: [...undone, edit] });
  }

  redo(): void {
    const { past, undone } = this.#steps();
    const edit = undone.at(-1);
    this.#gesture = null;
    edit?.do({ past: [...past, edit], undone: undone.slice(0, -1) });
  }
}

/**
 * The edit that shows `next` in place of the present value. Each direction brings back the value
 * that the other one replaced, with changes that no edit made.
 */
export function replacement<T>(
  name: string,
  next: T,
  now: () => T,
  show: (value: T, steps: Steps) => void,
): Edit {
  let [before, after] = [now(), next];
  return {
    name,
    do(steps) {
      before = now();
      show(after, steps);
    },
    undo(steps) {
      after = now();
      show(before, steps);
    },
  };
}

/** Direction of a key press: Ctrl+Z undoes, Ctrl+Shift+Z and Ctrl+Y redo, also with the command key. */
export function historyKey({
  key,
  ctrlKey,
  metaKey,
  shiftKey,
  altKey,
}: Pick<KeyboardEvent, 'key' | 'ctrlKey' | 'metaKey' | 'shiftKey' | 'altKey'>): 'undo' | 'redo' | null {
  if (!(ctrlKey || metaKey) || altKey) return null;
  const lower = key.toLowerCase();
  if (lower === 'z') return shiftKey ? 'redo' : 'undo';
  return lower === 'y' && !shiftKey ? 'redo' : null;
}
