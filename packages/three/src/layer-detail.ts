import type { Detail } from '@websplatter/core';
import type { LayerCloud } from './layer-cloud.ts';

/**
 * Returns the finest detail that any of the clouds of a frame asks for; null if none does. The
 * largest of their budgets is that of all together; an error beside a budget counts alone.
 */
export function layerDetail(clouds: Iterable<Pick<LayerCloud, 'detail'>>): Detail | null {
  const asked = [...clouds].flatMap(({ detail }) => detail ?? []);
  return asked.length > 0 ? asked.reduce(finerOf) : null;
}

function finerOf(a: Detail, b: Detail): Detail {
  if (a === 'full' || b === 'full') return 'full';
  const maxErrorPx = ofBoth(Math.min, a.maxErrorPx, b.maxErrorPx);
  const maxSplats = ofBoth(Math.max, a.maxSplats, b.maxSplats);
  if (maxErrorPx !== undefined) return { maxErrorPx, ...(maxSplats !== undefined && { maxSplats }) };
  if (maxSplats !== undefined) return { maxSplats };
  return { maxErrorPx: (a.maxErrorPx ?? b.maxErrorPx)! };
}

function ofBoth(pick: (a: number, b: number) => number, a?: number, b?: number): number | undefined {
  return a === undefined || b === undefined ? undefined : pick(a, b);
}
