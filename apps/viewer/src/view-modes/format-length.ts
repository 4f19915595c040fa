/** Three significant digits: `0`, `0.0123`, `4.57`, `1,230`, `1.2e+12`. */
export function formatLength(length: number): string {
  const magnitude = Math.abs(length);
  if (magnitude !== 0 && (magnitude < 1e-4 || magnitude >= 1e7)) return length.toPrecision(2);
  return rounded.format(length);
}

const rounded = new Intl.NumberFormat('en', { maximumSignificantDigits: 3 });
