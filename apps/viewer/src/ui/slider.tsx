import { type ComponentProps, type ReactNode, useId } from 'react';
import { useGesture } from './use-gesture.ts';

interface SliderProps extends Omit<ComponentProps<'input'>, 'onChange' | 'value'> {
  readonly label: string;
  readonly value: number;
  /** The value behind the slider, as text or as a field. */
  readonly shown: ReactNode;
  readonly testId: string;
  /** @param gesture the same object for all changes that are undone together. */
  readonly onValue: (value: number, gesture: object) => void;
}

/** A slider for a number, with a label. */
export function Slider({ label, shown, testId, onValue, ...range }: SliderProps) {
  const id = useId();
  const { gesture, begins } = useGesture();
  return (
    <div className="slider-row">
      <label htmlFor={id}>{label}</label>
      <input
        {...range}
        {...begins}
        id={id}
        type="range"
        data-testid={testId}
        onChange={({ target }) => onValue(target.valueAsNumber, gesture.current)}
      />
      {typeof shown === 'string' ? <output htmlFor={id}>{shown}</output> : shown}
    </div>
  );
}
