import { formatCount } from '@websplatter/kit/format';
import type { MapFigures } from '../state/view-mode.ts';
import { UNSEEN_COLOR, VALUE_RAMP } from './ramp.ts';
import { type ColorScale, evenTicks } from './scale.ts';

/** Low end of the contribution scale, log₂ px: smaller contributions change no pixel by 1/255. */
const LEAST_LOG = -8;
const MOST_LOG = 12;

/** Position of a contribution on its scale, 0…1 within the scale; takes its log₂. */
export function logPart(log2Px: number): number {
  return (log2Px - LEAST_LOG) / (MOST_LOG - LEAST_LOG);
}

/** The scale of counts; null if there are none. */
export function costScale(title: string, figures: MapFigures): ColorScale | null {
  if (figures.kind !== 'cost') return null;
  const { end, max } = figures;
  const ticks = evenTicks((part) => `${part === 1 && max > end ? '≥ ' : ''}${formatCount(part * end)}`);
  return { title, ...VALUE_RAMP, ticks };
}

export function contributionScale(figures: MapFigures): ColorScale | null {
  if (figures.kind !== 'contribution') return null;
  const textAt = (part: number) => {
    const log2Px = LEAST_LOG + part * (MOST_LOG - LEAST_LOG);
    return log2Px < 0 ? `1/${2 ** -log2Px}` : formatCount(2 ** log2Px);
  };
  const mark = (part: number) => (part === 0 ? '≤ ' : part === 1 ? '≥ ' : '');
  const ticks = evenTicks((part) => mark(part) + textAt(part));
  return { title: 'Contribution of a splat, in whole pixels', ...VALUE_RAMP, ticks };
}

export function tileNotes(figures: MapFigures): readonly string[] {
  if (figures.kind !== 'cost') return [];
  const notes = [`${mostAndMean(figures)} in a list.`];
  return figures.rasterizer === 'quads'
    ? [...notes, 'Quads draw this picture and need no lists. Shown are the lists that tiles would need.']
    : notes;
}

export function pixelNotes(figures: MapFigures): readonly string[] {
  if (figures.kind !== 'cost') return [];
  const { rasterizer, blendedPart } = figures;
  const most = `${mostAndMean(figures)} at a pixel`;
  if (rasterizer === 'quads') return [`${most}, all of them blended: quads draw what is hidden, too.`];
  return [`${most}; ${formatPart(blendedPart)} of them are blended there, the others miss the pixel.`];
}

export function contributionNotes(figures: MapFigures): readonly string[] {
  if (figures.kind !== 'contribution') return [];
  const { splats, unseen } = figures;
  if (splats === 0) return ['There are no splats in the picture.'];
  const of = `${formatCount(unseen)} of ${formatCount(splats)} splats in the picture`;
  return [
    `${of} (${formatPart(unseen / splats)}) contribute less than 1/256 of a pixel and are not seen: their places are ${UNSEEN_COLOR.name}.`,
  ];
}

function mostAndMean({ max, mean }: { readonly max: number; readonly mean: number }): string {
  return `At most ${formatCount(max)}, ${formatCount(Math.round(mean))} on average`;
}

function formatPart(part: number): string {
  const percent = 100 * part;
  return percent > 0 && percent < 1 ? '< 1 %' : `${Math.round(percent)} %`;
}
