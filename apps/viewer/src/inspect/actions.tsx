import { TextButton } from '@websplatter/kit/controls';
import { formatCount, formatSplats } from '@websplatter/kit/format';
import type { ComponentProps } from 'react';
import { useStore } from 'zustand';
import { redoEdit, undoEdit } from '../state/make-edit.ts';
import type { ViewerStore } from '../state/store.ts';

/** A button that keeps the focus while it is disabled. */
export function Action({
  isOff = false,
  onClick,
  ...rest
}: ComponentProps<typeof TextButton> & { readonly isOff?: boolean }) {
  return <TextButton {...rest} aria-disabled={isOff || undefined} onClick={isOff ? undefined : onClick} />;
}

/** Undo and redo of the newest edits, which need not be of this panel. */
export function StepActions({ store }: { store: ViewerStore }) {
  const last = useStore(store, (state) => state.past.at(-1)?.name);
  const next = useStore(store, (state) => state.undone.at(-1)?.name);
  return (
    <>
      <Action testId="undo" title="Ctrl+Z" isOff={last === undefined} onClick={() => undoEdit(store)}>
        Undo {last}
      </Action>
      <Action testId="redo" title="Ctrl+Shift+Z" isOff={next === undefined} onClick={() => redoEdit(store)}>
        Redo {next}
      </Action>
    </>
  );
}

/** `12 of 23,208 splats`, of those that are left; without their number before it is known. */
export function ofLeft(count: number, left: number | null): string {
  return left === null ? formatSplats(count) : `${formatCount(count)} of ${formatSplats(left)}`;
}
