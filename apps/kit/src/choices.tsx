/** A value, its label, and its name in tests if that differs from the label. */
export type Choice<Value> = readonly [value: Value, words: string, name?: string];

/** Chooses one of a few values: buttons in a row, joined or as chips. */
export function Choices<Value>({
  label,
  choices,
  chosen,
  testId,
  isChips = false,
  titleOf,
  onChoose,
}: {
  /** Omitted if the surroundings name the group. */
  label?: string;
  choices: readonly Choice<Value>[];
  /** Null if no choice matches. */
  chosen: Value | null;
  /** Prefix of each button's `data-testid`. */
  testId: string;
  isChips?: boolean;
  titleOf?: (value: Value) => string | undefined;
  onChoose: (value: Value) => void;
}) {
  return (
    <fieldset className={isChips ? 'chips' : 'segments'} aria-label={label}>
      {choices.map(([value, words, name = value]) => (
        <button
          key={words}
          type="button"
          className={isChips ? 'chip' : undefined}
          aria-pressed={value === chosen}
          title={titleOf?.(value)}
          data-testid={`${testId}${name}`}
          onClick={() => onChoose(value)}
        >
          {words}
        </button>
      ))}
    </fieldset>
  );
}
