/** A value that can be chosen, its words, and its name in tests if that is another. */
export type Choice<Value> = readonly [value: Value, words: string, name?: string];

/** One of a few values: buttons in a row, joined or as chips. */
export function Choices<Value>({
  label,
  choices,
  chosen,
  testId,
  isChips = false,
  titleOf,
  onChoose,
}: {
  /** Not where the surroundings name it. */
  label?: string;
  choices: readonly Choice<Value>[];
  /** Null where it is none of them. */
  chosen: Value | null;
  /** Beginning of each button's. */
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
