import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { FRONT } from '../camera/orbit-pose.fixture.ts';
import type { SavedView } from '../state/saved-view.ts';
import { joinedViews, MAX_SAVED_VIEWS, readPath, readViewList } from './view-list.ts';

const VIEW: SavedView = {
  pose: FRONT,
  fovDegrees: 50,
  isOrthographic: false,
  isFlipped: true,
  isZUp: false,
  name: 'Front',
  thumbnail: '/9j/',
};

describe('the list of saved views', () => {
  it('comes back as it was written', () => {
    expect(readViewList(JSON.stringify([VIEW]))).toEqual([VIEW]);
    expect(readViewList(null)).toEqual([]);
  });

  it('comes back from browsers that kept it before views had names', () => {
    const { name, ...nameless } = VIEW;
    expect(readViewList(JSON.stringify([nameless]))).toEqual([{ ...VIEW, name: '' }]);
  });

  it('begins with the views of a link: kept ones are those of the link but for their names', () => {
    const other = { ...VIEW, fovDegrees: 40, name: 'Side' };
    const linked = { ...VIEW, name: 'Entry', thumbnail: null };
    expect(joinedViews([linked], [other, VIEW])).toEqual([{ ...VIEW, name: 'Entry' }, other]);
    expect(joinedViews([linked], [other])).toEqual([linked, other]);
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
      { ...VIEW, name: 1 },
      { ...VIEW, thumbnail: 1 },
      { ...VIEW, toNextMs: 0 },
      { ...VIEW, passing: 'by' },
    ];
    expect(readViewList(JSON.stringify([...broken, VIEW]))).toEqual([VIEW]);
  });

  it('is read from any text without an error, and the path too', () => {
    fc.assert(
      fc.property(fc.oneof(fc.string(), fc.json()), (text) => {
        expect([readViewList(text), readPath(text)]).toEqual([expect.any(Array), expect.any(Array)]);
      }),
    );
  });

  it('comes with the path that was stored, and without one that is none', () => {
    const { name, thumbnail, ...view } = VIEW;
    const path = { isLooped: true, turntable: { view, durationMs: 10_000 } };
    expect(readPath(JSON.stringify(path))).toEqual([path]);
    for (const broken of [null, {}, { isLooped: 1 }, { ...path, turntable: { view, durationMs: 0 } }])
      expect(readPath(JSON.stringify(broken))).toEqual([]);
  });

  it('has the timing of a link, and the image that is stored', () => {
    const linked = { ...VIEW, thumbnail: null, toNextMs: 4000, passing: 'stop' } as const;
    expect(joinedViews([linked], [VIEW])).toEqual([{ ...linked, thumbnail: VIEW.thumbnail }]);
  });

  it('is no longer than what browsers can keep', () => {
    const many = Array.from({ length: 80 }, () => VIEW);
    expect(readViewList(JSON.stringify(many)).length).toBe(MAX_SAVED_VIEWS);
  });
});
