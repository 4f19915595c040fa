import type { SplatSet } from '@websplatter/core';
import { colorOf } from '@websplatter/core/own-data';
import { clamp, type Vec3 } from '../state/vec3.ts';

/** A splat's colour without its view-dependent part, sRGB-encoded, in integers 0…255. */
export function baseColorOf({ colorDc }: Pick<SplatSet, 'colorDc'>, index: number): Vec3 {
  const channel = (axis: number) => Math.round(255 * clamp(colorOf(colorDc[3 * index + axis]), 0, 1));
  return [channel(0), channel(1), channel(2)];
}
