/** Joins rows to lines, the cells of each column at one width: the first `leftAligned` columns begin in line, the others end. */
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
