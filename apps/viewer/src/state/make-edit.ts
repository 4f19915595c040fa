import type { Edit } from './history.ts';
import type { ViewerStore } from './store.ts';

/** Most edits that can be undone, if they hold little memory. */
export const MOST_EDITS = 1000;
/** Most memory of all of them: an edit of a selection holds one bit per splat. */
export const MOST_EDIT_BYTES = 2 ** 26;

/** Whether an edit of `gesture` joins the newest edit. */
export function continuesEdit(store: ViewerStore, gesture: unknown): boolean {
  const { past, gesture: newest } = store.getState();
  return gesture !== null && gesture === newest && past.length > 0;
}

/**
 * Makes an edit.
 *
 * @param gesture successive edits of one gesture are undone together; null for an edit of its own.
 */
export function makeEdit(store: ViewerStore, edit: Edit, gesture: unknown = null): void {
  edit.do();
  recordEdit(store, edit, gesture);
}

/** Takes an edit that has been made into the history. @param gesture as for `makeEdit`. */
export function recordEdit(store: ViewerStore, edit: Edit, gesture: unknown = null): void {
  const { past } = store.getState();
  const last = continuesEdit(store, gesture) ? past.at(-1) : undefined;
  const joined: Edit = last ? { ...edit, undo: last.undo } : edit;
  const steps = [...(last ? past.slice(0, -1) : past), joined].slice(-MOST_EDITS);
  store.setState({ past: withinMemory(steps), undone: [], gesture });
}

/** The newest edits that hold no more than they may; the last one in any case. */
function withinMemory(steps: readonly Edit[]): readonly Edit[] {
  let heldBytes = 0;
  const first = steps.findLastIndex(({ bytes = 0 }) => {
    heldBytes += bytes;
    return heldBytes > MOST_EDIT_BYTES;
  });
  return steps.slice(Math.min(first + 1, steps.length - 1));
}

/** Takes the newest edit back and returns it; undefined if there is none. */
export function undoEdit(store: ViewerStore): Edit | undefined {
  const { past, undone } = store.getState();
  const edit = past.at(-1);
  if (!edit) return undefined;
  edit.undo();
  const notice = `Undone: ${edit.name}.`;
  store.setState({ past: past.slice(0, -1), undone: [...undone, edit], gesture: null, notice });
  return edit;
}

/** Makes the edit again that was undone last, and returns it; undefined if there is none. */
export function redoEdit(store: ViewerStore): Edit | undefined {
  const { past, undone } = store.getState();
  const edit = undone.at(-1);
  if (!edit) return undefined;
  edit.do();
  const notice = `Redone: ${edit.name}.`;
  store.setState({ past: [...past, edit], undone: undone.slice(0, -1), gesture: null, notice });
  return edit;
}

/**
 * The edit that shows `next` in place of the present value. Each direction brings back the value
 * that the other one replaced, with changes that no edit made.
 */
export function replacement<T>(name: string, next: T, now: () => T, show: (value: T) => void): Edit {
  let [before, after] = [now(), next];
  return {
    name,
    do() {
      before = now();
      show(after);
    },
    undo() {
      after = now();
      show(before);
    },
  };
}
