import { encodePly } from '@websplatter/core';
import { GOLDEN_RATIO, hash, splatsOf } from './splats.ts';

const PLANTS = 260;
const STALK_SPLATS = 14;
const HEAD_SPLATS = 22;
const EACH = STALK_SPLATS + HEAD_SPLATS;
const HEADS: readonly (readonly number[])[] = [
  [0.93, 0.22, 0.16],
  [0.98, 0.76, 0.2],
  [0.45, 0.42, 0.9],
  [0.97, 0.96, 0.93],
];

/** Flowers in four colours on thin stalks, in a round bed. */
export function meadowPly(): Uint8Array {
  const splats = splatsOf(PLANTS * EACH, (i) => {
    const [plant, part] = [Math.floor(i / EACH), i % EACH];
    const angle = 2 * Math.PI * ((plant * GOLDEN_RATIO) % 1);
    const distance = 0.72 * Math.sqrt((plant + 0.5) / PLANTS);
    const [x, z] = [distance * Math.cos(angle), distance * Math.sin(angle)];
    const top = 0.05 + 0.35 * hash(plant);
    const foot = -0.4;
    if (part < STALK_SPLATS) {
      const share = part / STALK_SPLATS;
      const light = 0.45 + 0.55 * share;
      return {
        position: [x + 0.02 * (hash(plant, 4) - 0.5) * share, foot + (top - foot) * share, z],
        scale: [0.004, (top - foot) / STALK_SPLATS / 1.6, 0.004],
        color: [0.26 * light, 0.62 * light, 0.2 * light],
      };
    }
    const petal = 2 * Math.PI * (((part - STALK_SPLATS) * GOLDEN_RATIO) % 1);
    const reach = 0.03 * Math.sqrt((part - STALK_SPLATS) / HEAD_SPLATS);
    const light = 0.7 + 10 * reach;
    return {
      position: [x + reach * Math.cos(petal), top + 0.35 * reach, z + reach * Math.sin(petal)],
      scale: [0.009, 0.004, 0.009],
      axis: [-Math.cos(petal) * 0.5, 1, -Math.sin(petal) * 0.5],
      color: HEADS[plant % HEADS.length].map((value) => value * light),
    };
  });
  return encodePly(splats);
}
