import { expect, it } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { Annotation } from '../state/annotating.ts';
import { joinedAnnotations, readAnnotationList, writeAnnotationList } from './annotation-list.ts';

const VIEW = { pose: FRONT, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false };
const JUG: Annotation = { point: [0, 1, 0], title: 'Jug', text: 'Old.', view: VIEW };

it('annotations come back from the browser, without what is none', () => {
  const [read, ...others] = readAnnotationList(writeAnnotationList([JUG]));
  expect(read).toMatchObject({ title: 'Jug', text: 'Old.', point: [0, 1, 0] });
  expect(others).toEqual([]);
  for (const text of [null, '', '{}', '[1, "x", null]']) expect(readAnnotationList(text)).toEqual([]);
});

it('those of a link come first, and stand for kept ones of the same place', () => {
  const other = { ...JUG, point: [2, 0, 0] as const };
  const renamed = { ...JUG, title: 'Old jug' };
  expect(joinedAnnotations([renamed], [other, JUG])).toEqual([renamed, other]);
});
