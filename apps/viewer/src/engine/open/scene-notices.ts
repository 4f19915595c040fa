import type { CloudFit, DropCounts, SceneFraming } from '@websplatter/core';
import { formatBytes, formatCount } from '@websplatter/kit/format';
import { describeEdits } from '../../state/describe-edits.ts';
import type { Inspecting } from '../../state/inspecting.ts';
import type { Notice, Offer } from '../../state/messages.ts';
import type { SceneWarning } from '../../state/scene.ts';
import { droppedTotal } from './dropped-words.ts';

/** Confidence below which the alternatives are offered. */
export const SURE = 0.5;

const OTHER_WAY_UP: Offer = { label: 'Other way up', command: 'flip' };
const FROM_OUTSIDE: Offer = { label: 'Look from outside', command: 'outside' };
const FROM_INSIDE: Offer = { label: 'Look from inside', command: 'inside' };

/** The notice for a first view whose up or kind is uncertain, with buttons for the alternatives; null if both are certain. */
export function framingNotice({ kind, confidence }: SceneFraming): Notice | null {
  const isUpSure = confidence.up >= SURE;
  const isKindSure = confidence.kind >= SURE;
  if (isUpSure && isKindSure) return null;
  const fromOther = kind === 'object' ? FROM_INSIDE : FROM_OUTSIDE;
  if (isKindSure) return { text: 'It is not certain which way is up in this scene.', offers: [OTHER_WAY_UP] };
  const text =
    kind === 'object' ? 'This may be a place to look around in.' : 'This may be an object to look at.';
  if (isUpSure) return { text, offers: [fromOther] };
  return { text: `${text} Nor is it certain which way is up.`, offers: [fromOther, OTHER_WAY_UP] };
}

const LIST = new Intl.ListFormat('en');

/** The notice that a scene has coarser settings than requested because GPU memory is too small. */
export function fitNotice(title: string, { wanted, taken, wantedBytes, takenBytes }: CloudFit): string {
  const changes = [
    taken.geometryPrecision !== wanted.geometryPrecision && `${taken.geometryPrecision} geometry`,
    taken.shPrecision !== wanted.shPrecision && `${taken.shPrecision} harmonics`,
    taken.shDegree !== wanted.shDegree &&
      `harmonics of degree ${taken.shDegree} instead of ${wanted.shDegree}`,
  ].filter((change) => change !== false);
  return `${title} needs ${formatBytes(wantedBytes)}, more than the GPU has left. It is shown with ${LIST.format(changes)}, in ${formatBytes(takenBytes)}.`;
}

/** Offers to bring a replaced scene back with its edits. */
export function leftNotice(title: string, inspecting: Inspecting): Notice {
  const text = `${title} had ${describeEdits(inspecting)}.`;
  return { text, offers: [{ label: 'Bring back', command: 'bring-back' }] };
}

/** A warning if at least half of the rows were dropped, which changes the image; else null. */
export function droppedWarning(name: string, kept: number, dropped: DropCounts): SceneWarning | null {
  const left = droppedTotal(dropped);
  const rows = kept + left;
  if (left === 0 || left < rows / 2) return null;
  // Rounded down: 100% would say that nothing is shown.
  const percent = Math.floor((100 * left) / rows);
  const part = left === rows / 2 ? 'Half' : percent === 50 ? 'More than half' : `${percent}%`;
  return {
    title: `${part} of the splats were left out`,
    message: `${formatCount(left)} of the ${formatCount(rows)} rows in ${name} hold values that are not usable numbers. The rest is shown, but the file is probably damaged.`,
  };
}
