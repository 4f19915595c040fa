import type { SceneFraming } from '@websplatter/core';
import type { Notice, Offer } from '../state/messages.ts';

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
