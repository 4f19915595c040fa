import { type ComponentProps, type ReactNode, useId } from 'react';

interface SliderProps extends Omit<ComponentProps<'input'>, 'onChange' | 'value'> {
  readonly label: string;
  readonly value: number;
  /** The value as it is written behind the slider, or a field for it. */
  readonly shown: ReactNode;
  readonly testId: string;
  readonly onValue: (value: number) => void;
}

/** A number at a slider, with its name before it. */
export function Slider({ label, shown, testId, onValue, ...range }: SliderProps) {
  const id = useId();
  return (
    <div className="slider-row">
      <label htmlFor={id}>{label}</label>
      <input
        {...range}
        id={id}
        type="range"
        data-testid={testId}
        onChange={({ target }) => onValue(target.valueAsNumber)}
      />
      {typeof shown === 'string' ? <output htmlFor={id}>{shown}</output> : shown}
    </div>
  );
}
