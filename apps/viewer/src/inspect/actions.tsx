import { TextButton } from '@websplatter/kit/controls';
import type { ComponentProps } from 'react';
import { useStore } from 'zustand';
import type { InspectProps } from './inspection.ts';

/** A button that keeps the focus while it is disabled. */
export function Action({
  isOff = false,
  onClick,
  ...rest
}: ComponentProps<typeof TextButton> & { readonly isOff?: boolean }) {
  return <TextButton {...rest} aria-disabled={isOff || undefined} onClick={isOff ? undefined : onClick} />;
}

/** Undo and redo of crops and selections. */
export function StepActions({ store, inspection }: InspectProps) {
  const { past, undone } = useStore(store, (state) => state.inspecting);
  return (
    <>
      <Action testId="undo" title="Undo (Ctrl+Z)" isOff={past.length === 0} onClick={() => inspection.undo()}>
        Undo
      </Action>
      <Action
        testId="redo"
        title="Redo (Ctrl+Shift+Z)"
        isOff={undone.length === 0}
        onClick={() => inspection.redo()}
      >
        Redo
      </Action>
    </>
  );
}
