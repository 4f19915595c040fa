import type { SavingState } from '../state/saving.ts';
import { Running } from '../ui/running.tsx';

const PHASES = { read: 'Reading the scene again', write: 'Writing' } as const;

/** How far a file is that is being written, and a button to cancel it. */
export function SavingProgress({
  running,
  name,
  onCancel,
}: {
  running: SavingState;
  name: 'save' | 'page';
  onCancel: () => void;
}) {
  return (
    <Running
      label={`${PHASES[running.phase]}: ${running.fileName}`}
      about={`Saving ${running.fileName}`}
      value={running.part}
      max={1}
      onCancel={onCancel}
      testId={name === 'save' ? 'saving' : 'saving-page'}
      cancelId={`cancel-${name}`}
    />
  );
}
