import { useState } from 'react';
import { useGesture } from './use-gesture.ts';

interface NumberFieldProps {
  readonly label: string;
  readonly value: number;
  /** Added per click on an arrow. */
  readonly step: number | 'any';
  readonly min?: number;
  readonly testId: string;
  /** @param gesture the same object for all changes that are undone together. */
  readonly onChange: (value: number, gesture: object) => void;
}

/**
 * A field for a number. Each valid input takes effect at once; leaving the field restores the last
 * valid number.
 */
export function NumberField({ label, value, step, min, testId, onChange }: NumberFieldProps) {
  const [text, setText] = useState<string | null>(null);
  const { gesture, begins } = useGesture();
  const write = (written: string, typed: number) => {
    setText(written);
    if (Number.isFinite(typed) && (min === undefined || typed >= min)) onChange(typed, gesture.current);
  };
  return (
    <input
      {...begins}
      type="number"
      aria-label={label}
      value={text ?? String(value)}
      step={step}
      min={min}
      data-testid={testId}
      onChange={({ target }) => write(target.value, target.valueAsNumber)}
      onBlur={() => setText(null)}
    />
  );
}
