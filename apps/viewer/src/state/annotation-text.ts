import { InvalidArgumentError } from '@websplatter/core';
import { numberPart } from './address-parts.ts';
import type { Annotation } from './annotating.ts';
import { decodeKeptView, encodeKeptView, roundedPoint } from './view-text.ts';

/** What begins the words, which are last: the title's line, then the text's. */
const WORDS = ',words:';

/**
 * For the address, one annotation: its place, the view that shows it, then its title and, from the
 * next line on, its text: `0:0.5:0,0,0.1,0,2.5,0.35,1.25,words:The jug`. Numbers are rounded as
 * those of saved views.
 */
export function encodeAnnotation({ point, title, text, view }: Annotation): string {
  const place = roundedPoint(point, view.pose.distance).join(':');
  const words = text.trim() ? `${title.trim()}\n${text.trim()}` : title.trim();
  return `${place},${encodeKeptView(view)}${words && WORDS + words}`;
}

/**
 * Reads the text of `encodeAnnotation`.
 *
 * @throws InvalidArgumentError naming the part that cannot be.
 */
export function decodeAnnotation(text: string): Annotation {
  const end = text.indexOf(WORDS);
  const [numbers, words] = end < 0 ? [text, ''] : [text.slice(0, end), text.slice(end + WORDS.length)];
  const [place, ...camera] = numbers.split(',');
  const [x, y, z, ...others] = place.split(':').map((part) => numberPart(part.trim(), refused));
  if (z === undefined || others.length > 0) throw refused(`${place} is not three numbers`);
  const [title, ...lines] = words.split('\n');
  return {
    point: [x, y, z],
    title: title.trim(),
    text: lines.join('\n').trim(),
    view: decodeKeptView(camera.join(',')),
  };
}

function refused(why: string): InvalidArgumentError {
  const form = 'write annotation=x:y:z, a comma, a camera as in camera=, and ,words:title';
  return new InvalidArgumentError('annotation', `Its place cannot be read: ${why}; ${form}.`);
}
