/** A measurement as the page shows it: everything as text. */
export interface Measured {
  /** Subject, device and method of the measurement; the adapter comes first. */
  readonly facts: readonly string[];
  /** Titles of the columns; the first names the rows. */
  readonly columns: readonly string[];
  readonly rows: readonly (readonly string[])[];
  /** Cautions, as sentences. */
  readonly notes: readonly string[];
}

/** A measurement as a Markdown table to paste. */
export function measuredText({ facts, columns, rows, notes }: Measured): string {
  const line = (cells: readonly string[]) => `| ${cells.join(' | ')} |`;
  return [
    facts.join(' · '),
    '',
    line(columns),
    line(columns.map((_, i) => (i === 0 ? '---' : '---:'))),
    ...rows.map(line),
    ...(notes.length > 0 ? ['', ...notes.map((note) => `Note: ${note}`)] : []),
    '',
  ].join('\n');
}
