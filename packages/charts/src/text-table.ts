/** Joins rows to lines, in columns: the first `leftAligned` to the left, others to the right. */
export function alignedColumns(rows: readonly (readonly string[])[], leftAligned: number): string[] {
  const widths = rows[0].map((_, column) => Math.max(...rows.map((row) => row[column].length)));
  return rows.map((row) =>
    row
      .map((cell, column) =>
        column < leftAligned ? cell.padEnd(widths[column]) : cell.padStart(widths[column]),
      )
      .join('  ')
      .trimEnd(),
  );
}
