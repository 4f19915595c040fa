import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { SavedView } from '../state/saved-view.ts';
import { MAX_SAVED_VIEWS, readViewList } from './view-list.ts';

const VIEW: SavedView = {
  pose: FRONT,
  fovDegrees: 50,
  isOrthographic: false,
  isFlipped: true,
  isZUp: false,
  thumbnail: '/9j/',
};

describe('the list of saved views', () => {
  it('comes back as it was written', () => {
    expect(readViewList(JSON.stringify([VIEW]))).toEqual([VIEW]);
    expect(readViewList(null)).toEqual([]);
  });

  it('leaves out what is no view', () => {
    const broken = [
      null,
      {},
      { ...VIEW, pose: { ...FRONT, distance: 0 } },
      { ...VIEW, pose: { ...FRONT, up: [0, 0, 0] } },
      { ...VIEW, pose: { ...FRONT, target: [1, 2] } },
      { ...VIEW, fovDegrees: 180 },
      { ...VIEW, isZUp: 'no' },
    ];
    expect(readViewList(JSON.stringify([...broken, VIEW]))).toEqual([VIEW]);
  });

  it('is read from any text without an error', () => {
    fc.assert(fc.property(fc.oneof(fc.string(), fc.json()), (text) => readViewList(text).length >= 0));
  });

  it('is no longer than what browsers can keep', () => {
    const many = Array.from({ length: 80 }, () => VIEW);
    expect(readViewList(JSON.stringify(many)).length).toBe(MAX_SAVED_VIEWS);
  });
});
