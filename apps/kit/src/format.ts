/** Formats numbers for the interface: short, and steady in width. */

const wholeNumber = new Intl.NumberFormat('en', { maximumFractionDigits: 0 });

/** Shown for an unknown number. */
export const UNKNOWN = '–';

/** `1,234,567`. */
export function formatCount(count: number): string {
  return Number.isFinite(count) ? wholeNumber.format(count) : UNKNOWN;
}

/** `150,000`, `1.2 million`. */
export function formatMany(count: number): string {
  return count < 999_950 ? formatCount(count) : `${(count / 1e6).toFixed(1)} million`;
}

/**
 * A number of any magnitude with `digits` significant digits: `0.0123`, `4.57`, `1,230`, `1.2 × 10¹²`.
 * The last digits of thousands are kept.
 */
export function formatRough(value: number, digits = 2): string {
  if (!Number.isFinite(value)) return value > 0 ? '∞' : value < 0 ? '−∞' : UNKNOWN;
  const magnitude = Math.abs(value);
  const isShort = magnitude === 0 || (magnitude >= 1e-4 && magnitude < 1e7);
  if (isShort)
    return new Intl.NumberFormat('en', { maximumSignificantDigits: digits }).format(value).replace('-', '−');
  const [figures, exponent] = value
    .toExponential(digits - 1)
    .replace('-', '−')
    .split('e');
  return `${figures} × 10${superscript(exponent)}`;
}

/** `¹²` for `+12`. */
function superscript(exponent: string): string {
  const digits = [...exponent.replace('+', '').replace('−', '-')];
  return digits.map((digit) => (digit === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(digit)])).join('');
}

/** Three significant digits at most: `0.04`, `3.1`, `118`. */
export function formatMs(elapsedMs: number): string {
  if (!Number.isFinite(elapsedMs)) return UNKNOWN;
  if (elapsedMs < 1) return elapsedMs.toFixed(2);
  return elapsedMs < 99.95 ? elapsedMs.toFixed(1) : wholeNumber.format(elapsedMs);
}

/** `59`, or `3.2` if an integer would be too coarse. */
export function formatRate(framesPerSecond: number): string {
  if (!Number.isFinite(framesPerSecond)) return UNKNOWN;
  return framesPerSecond < 9.95 ? framesPerSecond.toFixed(1) : wholeNumber.format(framesPerSecond);
}

/** `48.3` for decibels; `identical` for identical images. */
export function formatDb(psnrDb: number): string {
  return Number.isFinite(psnrDb) ? psnrDb.toFixed(1) : 'identical';
}

/** `48.3 dB`, or `identical to the reference`. */
export function formatPsnr(psnrDb: number): string {
  return Number.isFinite(psnrDb) ? `${formatDb(psnrDb)} dB` : 'identical to the reference';
}

/** An approximate duration: `0.8 s`, `12 s`, `3 min`. */
export function formatDuration(elapsedMs: number): string {
  const seconds = elapsedMs / 1000;
  if (seconds >= 99.5) return `${Math.round(seconds / 60)} min`;
  return `${seconds < 9.95 ? seconds.toFixed(1) : Math.round(seconds)} s`;
}

const BYTE_UNITS = ['B', 'kB', 'MB', 'GB', 'TB'];

/** Decimal units, as file managers and drive makers count: `68 B`, `1.2 MB`, `34 MB`. */
export function formatBytes(bytes: number): string {
  if (!Number.isFinite(bytes)) return UNKNOWN;
  let unit = 0;
  let value = bytes;
  // 999.5 would be written as 1000.
  while (value >= 999.5 && unit < BYTE_UNITS.length - 1) {
    value /= 1000;
    unit++;
  }
  return `${unit === 0 || value >= 9.95 ? Math.round(value) : value.toFixed(1)} ${BYTE_UNITS[unit]}`;
}

/** `3.0 of 4.7 MB`, `12 kB of 4.7 MB`. */
export function formatBytesOf(bytes: number, totalBytes: number): string {
  const [part, total] = [formatBytes(bytes), formatBytes(totalBytes)];
  const unit = total.slice(total.indexOf(' '));
  return `${part.endsWith(unit) ? part.slice(0, -unit.length) : part} of ${total}`;
}

/** `1 splat`, `2 splats`. */
export function formatSplats(count: number): string {
  return `${formatCount(count)} ${count === 1 ? 'splat' : 'splats'}`;
}

/** Last part of a path or URL, without query; the whole path if there is none. */
export function baseName(path: string): string {
  const withoutQuery = path.replace(/[?#].*$/, '');
  const last = withoutQuery.split(/[\\/]/).filter(Boolean).at(-1);
  if (!last) return path;
  try {
    return decodeURIComponent(last);
  } catch {
    // A lone % is no escape: the name is shown as it is written.
    return last;
  }
}
