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
  whyNotOf,
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
  /** Why a value cannot be chosen; null if it can. */
  whyNotOf?: (value: Value) => string | null;
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
          disabled={whyNotOf !== undefined && whyNotOf(value) !== null}
          title={whyNotOf?.(value) ?? titleOf?.(value)}
          data-testid={`${testId}${name}`}
          onClick={() => onChoose(value)}
        >
          {words}
        </button>
      ))}
    </fieldset>
  );
}
