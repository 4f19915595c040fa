import { useState } from 'react';

interface NumberFieldProps {
  readonly label: string;
  readonly value: number;
  /** Added by a click on an arrow. */
  readonly step: number | 'any';
  readonly min?: number;
  readonly testId: string;
  readonly onChange: (value: number) => void;
}

/** A number that can be typed: it counts whenever the text is one; leaving corrects the text. */
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
