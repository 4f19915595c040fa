import type { ComponentProps } from 'react';
import { Icon, type IconName } from './icon.tsx';

interface ButtonProps extends Omit<ComponentProps<'button'>, 'type'> {
  readonly testId?: string;
}

const LOOKS = { outlined: 'text-button outlined', primary: 'text-button primary', plain: 'text-button' };

/** A button with words. */
export function TextButton({
  look = 'outlined',
  testId,
  ...rest
}: ButtonProps & { look?: keyof typeof LOOKS }) {
  return <button {...rest} type="button" className={LOOKS[look]} data-testid={testId} />;
}

/** A button with a picture alone: `label` names it for those who do not see that. */
export function IconButton({
  icon,
  label,
  testId,
  ...rest
}: ButtonProps & { icon: IconName; label: string }) {
  return (
    <button className="icon-button" {...rest} type="button" aria-label={label} data-testid={testId}>
      <Icon name={icon} />
    </button>
  );
}

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
  titleOf?: (value: Value) => string;
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
