import { TextButton } from './controls.tsx';

/** What is under way, how far it has come, and a button to cancel it. */
export function Running({
  label,
  about,
  value,
  max,
  onCancel,
  testId,
  cancelId,
}: {
  /** A sentence to read. */
  readonly label: string;
  /** Names the bar for those who do not see it. */
  readonly about: string;
  /** Undefined while that is unknown. */
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
