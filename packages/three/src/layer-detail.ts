import type { Detail } from '@websplatter/core';
import type { LayerCloud } from './layer-cloud.ts';

/** Returns the finest detail that any of the clouds of a frame asks for; null if none does. */
export function layerDetail(clouds: Iterable<Pick<LayerCloud, 'detail'>>): Detail | null {
  const asked = [...clouds].flatMap(({ detail }) => detail ?? []);
  return asked.length > 0 ? asked.reduce(finerOf) : null;
}

function finerOf(a: Detail, b: Detail): Detail {
  if (a === 'full' || b === 'full') return 'full';
  return a.maxErrorPx <= b.maxErrorPx ? a : b;
}
