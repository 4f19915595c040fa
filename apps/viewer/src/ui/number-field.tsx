import { useState } from 'react';

interface NumberFieldProps {
  readonly label: string;
  readonly value: number;
  /** Added per click on an arrow. */
  readonly step: number | 'any';
  readonly min?: number;
  readonly testId: string;
  readonly onChange: (value: number) => void;
}

/**
 * A field for a number. Each valid input takes effect at once; leaving the field restores the last
 * valid number.
 */
export function NumberField({ label, value, step, min, testId, onChange }: NumberFieldProps) {
  const [text, setText] = useState<string | null>(null);
  const write = (written: string, typed: number) => {
    setText(written);
    if (Number.isFinite(typed) && (min === undefined || typed >= min)) onChange(typed);
  };
  return (
    <input
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
