import { type ComponentProps, type ReactNode, useId } from 'react';

interface SliderProps extends Omit<ComponentProps<'input'>, 'onChange' | 'value'> {
  readonly label: string;
  readonly value: number;
  /** The value behind the slider, as text or as a field. */
  readonly shown: ReactNode;
  readonly testId: string;
  readonly onValue: (value: number) => void;
}

/** A slider for a number, with a label. */
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
