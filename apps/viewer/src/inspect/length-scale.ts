import { formatRough } from '@websplatter/kit/format';
import { LENGTH_UNITS, type LengthScale, type LengthUnit } from '../state/inspecting.ts';

/** Storage key of a scene's scale. */
export function lengthScaleKey(contentKey: string): string {
  return `websplatter:length-scale:${contentKey}`;
}

/** Reads a stored scale; null if the text is invalid. */
export function readLengthScale(text: string | null): LengthScale | null {
  if (text === null) return null;
  try {
    const { perSceneUnit, unit } = JSON.parse(text) ?? {};
    return isLength(perSceneUnit) && LENGTH_UNITS.includes(unit) ? { perSceneUnit, unit } : null;
  } catch {
    // What is stored is no JSON: the scene has no scale, as on a first visit.
    return null;
  }
}

/**
 * The scale in which `distance` scene units are `length`; null if either is not a positive number.
 */
export function scaleFrom(distance: number, length: number, unit: LengthUnit): LengthScale | null {
  const perSceneUnit = length / distance;
  return isLength(length) && isLength(perSceneUnit) ? { perSceneUnit, unit } : null;
}

function isLength(value: unknown): value is number {
  return typeof value === 'number' && Number.isFinite(value) && value > 0;
}

/** `1.37 m`, or `2.41 units` without a scale; four significant digits at most. */
export function formatLength(distance: number, scale: LengthScale | null): string {
  const length = scale ? distance * scale.perSceneUnit : distance;
  return `${formatFigure(length, 4)} ${scale ? scale.unit : 'units'}`;
}

/** A number with `digits` significant digits: `0.00213`, `−12.4`, `1.30 × 10⁻⁷`. */
export function formatFigure(value: number, digits = 5): string {
  const magnitude = Math.abs(value);
  const isDecimal = magnitude === 0 || (magnitude >= 1e-4 && magnitude < 1e7);
  return isDecimal
    ? Number(value.toPrecision(digits)).toString().replace('-', '−')
    : formatRough(value, digits);
}
