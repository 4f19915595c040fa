import { InvalidArgumentError } from '@websplatter/core';
import { expect, it } from 'vitest';
import { PLAIN_LOOK } from '../../state/scene-part.ts';
import { changedPlacement, placedLook, uprightPlacement } from '../open/placement.ts';
import { PLACE_FIELD } from './place-link.ts';

const file = { ownUp: '-y', middle: [0.1, 0.2, 0.3] } as const;
const upright = uprightPlacement(file, '-y');

it.each([
  [PLAIN_LOOK, ''],
  [{ ...PLAIN_LOOK, isHidden: true, opacity: 0.1 }, 'opacity:0.1,hidden:1'],
  [
    placedLook(PLAIN_LOOK, changedPlacement(upright, { move: [0.1, 0, -1e21] }, file), file),
    'move:0.1:0:-1e+21',
  ],
  [
    placedLook(PLAIN_LOOK, changedPlacement(upright, { turnDegrees: [0, 1 / 3, 0], scale: 2 }, file), file),
    `turn:0:${1 / 3}:0,scale:2,about:0.1:0.2:0.3`,
  ],
  [placedLook(PLAIN_LOOK, changedPlacement(upright, { up: 'z' }, file), file), 'up:z:-y'],
])('the look of a file, %#, reads back as the same', (look, text) => {
  expect(PLACE_FIELD.encode(look)).toBe(text);
  expect(PLACE_FIELD.decode(text)(file)).toEqual(look);
});

/**
 * @fault Arguments: `place=` moves or scales a file out of float32's range, or so far that its size is
 *   lost
 * @consequence the part is left out with the reason; the scene is framed from as near as numbers allow
 */
it.each([
  ['move:1:2', 'move:1:2 is not three numbers'],
  ['move:1:2:x', '“x” is no number'],
  ['turn:1::2', 'a number is missing'],
  ['scale:0', 'scale:0 is not above 0'],
  ['scale:1e308', '1e308 is not within'],
  ['scale:1e-300', 'scale:1e-300 does not lie between'],
  ['move:0:-1e308:0', '-1e308 is not within'],
  ['opacity:2', 'opacity:2 does not lie between 0 and 1'],
  ['up:y:x', 'up:y:x is not two of y, -y, z, -z'],
  ['spin:1', '“spin:1” is not one of its parts'],
])('%s is refused: %s', (text, reason) => {
  expect(() => PLACE_FIELD.decode(text)).toThrow(InvalidArgumentError);
  expect(() => PLACE_FIELD.decode(text)).toThrow(reason);
});
