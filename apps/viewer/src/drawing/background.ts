import type { Vec3 } from '../camera/vec3.ts';

/**
 * Calls `onColor` with the style sheet's background of `element`, sRGB 0…1: now and when the colour scheme changes.
 * Returns what stops that.
 */
export function observeBackground(element: Element, onColor: (color: Vec3) => void): () => void {
  const report = () => onColor(backgroundOf(element));
  report();
  const scheme = matchMedia('(prefers-color-scheme: dark)');
  scheme.addEventListener('change', report);
  return () => scheme.removeEventListener('change', report);
}

function backgroundOf(element: Element): Vec3 {
  const channels =
    getComputedStyle(element)
      .backgroundColor.match(/[\d.]+/g)
      ?.map(Number) ?? [];
  const [red = 0, green = 0, blue = 0] = channels;
  return [red / 255, green / 255, blue / 255];
}
