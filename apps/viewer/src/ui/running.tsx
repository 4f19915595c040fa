import { TextButton } from '@websplatter/kit/controls';

/** A progress bar with a label, and a button that cancels the work. */
export function Running({
  label,
  about,
  value,
  max,
  onCancel,
  testId,
  cancelId,
}: {
  /** A sentence about the work, visible. */
  readonly label: string;
  /** Accessible name of the progress bar. */
  readonly about: string;
  /** Undefined while the progress is unknown. */
  readonly value: number | undefined;
  readonly max: number;
  readonly onCancel: () => void;
  readonly testId: string;
  readonly cancelId?: string;
}) {
  return (
    <div className="runner" data-testid={testId}>
      <div className="spread runner-row">
        <p data-testid={`${testId}-label`}>{label}</p>
        <TextButton look="plain" testId={cancelId} onClick={onCancel}>
          Cancel
        </TextButton>
      </div>
      <progress aria-label={about} value={value} max={max} data-testid={`${testId}-progress`} />
    </div>
  );
}
