import type { Detail } from '@websplatter/core';
import type { LayerCloud } from './layer-cloud.ts';

/**
 * Returns the finest detail that any cloud of a frame requests; null if no cloud does. From finest
 * to coarsest: `full`, a PSNR, limits, a frame time, `auto`. The largest of several budgets holds
 * for all clouds together. If one cloud limits the error and another has a budget, the error wins.
 */
export function layerDetail(clouds: Iterable<Pick<LayerCloud, 'detail'>>): Detail | null {
  const asked = [...clouds].flatMap(({ detail }) => detail ?? []);
  return asked.length > 0 ? asked.reduce(finerOf) : null;
}

function finerOf(a: Detail, b: Detail): Detail {
  const [first, second] = [a, b].map(rankOf);
  if (first !== second) return first < second ? a : b;
  if (typeof a === 'string') return a;
  const limits = Object.entries(a).flatMap(([name, own]) => {
    const other = numberIn(b, name);
    if (own === undefined || other === undefined) return [];
    return [[name, name === 'maxErrorPx' ? Math.min(own, other) : Math.max(own, other)]];
  });
  if (limits.length > 0) return Object.fromEntries(limits);
  const order = ['maxErrorPx', 'maxShare', 'maxSplats'] as const;
  const named = order.find((name) => numberIn(a, name) !== undefined || numberIn(b, name) !== undefined)!;
  return numberIn(a, named) === undefined ? b : a;
}

function rankOf(detail: Detail): number {
  if (detail === 'full') return 0;
  if (detail === 'auto') return 4;
  if (numberIn(detail, 'minPsnrDb') !== undefined) return 1;
  return numberIn(detail, 'maxFrameMs') !== undefined ? 3 : 2;
}

function numberIn(detail: Detail, name: string): number | undefined {
  return (detail as Partial<Record<string, number>>)[name];
}
