import { expect, it } from 'vitest';
import { PLAIN_LOOK } from '../../state/scene-part.ts';
import {
  changedPlacement,
  matrixOf,
  placedLook,
  placedMiddle,
  placementOf,
  uprightPlacement,
} from './placement.ts';

const file = { ownUp: '-y', middle: [1, 2, 3] } as const;
const asSaved = uprightPlacement(file, '-y');

function transformed(matrix: ArrayLike<number>, [x, y, z]: readonly number[]): number[] {
  return [0, 1, 2].map((i) => matrix[i] * x + matrix[4 + i] * y + matrix[8 + i] * z + matrix[12 + i]);
}

it('leaves a file as it was saved until something is changed', () => {
  expect(placedLook(PLAIN_LOOK, asSaved, file)).toEqual(PLAIN_LOOK);
  expect(placementOf({ ...file, look: PLAIN_LOOK })).toEqual(asSaved);
  expect(placedLook(PLAIN_LOOK, { ...asSaved, turnDegrees: [0, 360, 0] }, file)).toEqual(PLAIN_LOOK);
});

it('turns and scales about the middle, then moves', () => {
  const placement = changedPlacement(asSaved, { move: [10, 0, 0], turnDegrees: [0, 0, 90], scale: 2 }, file);
  const { modelMatrix = [] } = placedLook(PLAIN_LOOK, placement, file);
  expect(placedMiddle(placement)).toEqual([11, 2, 3]);
  expect(transformed(modelMatrix, file.middle)).toEqual([11, 2, 3]);
  expect(transformed(modelMatrix, [2, 2, 4])).toEqual([11, 4, 5]);
});

it('stands a file upright by a turn about its origin, and turns it about its new middle', () => {
  const placement = uprightPlacement({ ownUp: 'z', middle: [1, 2, 3] }, 'y');
  expect(transformed(matrixOf(placement), [0, 0, 1])).toEqual([0, 1, 0]);
  expect(placement.about).toEqual([1, 3, -2]);
  const flipped = changedPlacement(placement, { up: '-z' }, { ownUp: 'z', middle: [1, 2, 3] });
  expect(transformed(matrixOf(flipped), [0, 0, 1])).toEqual([0, -1, 0]);
  expect(flipped.about).toEqual([1, -3, 2]);
});
