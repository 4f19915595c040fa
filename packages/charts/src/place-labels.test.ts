import { describe, expect, it } from 'vitest';
import { type LabelBox, placeAllLabels, placeLabels } from './place-labels.ts';

const AREA = { left: 0, top: 0, right: 200, bottom: 100 };
const size = { width: 40, height: 12 };
const boxAt = (left: number, top: number, { width, height } = size) => ({
  ...{ left, top, right: left + width, bottom: top + height },
});

function expectApart(boxes: readonly LabelBox[]): void {
  for (const [i, a] of boxes.entries()) {
    for (const b of boxes.slice(i + 1)) {
      const areApartX = a.right <= b.left || b.right <= a.left;
      const areApartY = a.bottom <= b.top || b.bottom <= a.top;
      expect(areApartX || areApartY).toBe(true);
    }
  }
}

describe('names of points', () => {
  it('stand to the right where there is room', () => {
    expect(placeLabels([{ x: 50, y: 50, ...size }], AREA, [])).toEqual([boxAt(58, 44)]);
  });

  it('may touch the edges of the area', () => {
    const label = { x: 92, y: 50, width: 100, height: 100 };
    expect(placeLabels([label], AREA, [])).toEqual([boxAt(100, 0, label)]);
  });

  it('move to the left at the right edge, and below at the top', () => {
    expect(placeLabels([{ x: 190, y: 50, ...size }], AREA, [])).toEqual([boxAt(142, 44)]);
    const wide = { width: 120, height: 12 };
    expect(placeLabels([{ x: 100, y: 5, ...wide }], AREA, [])).toEqual([boxAt(40, 13, wide)]);
  });

  it('stand beside a line rather than on it, and on it rather than nowhere', () => {
    const point = { x: 50, y: 50, ...size };
    const across = { left: 0, top: 49, right: 200, bottom: 51 };
    expect(placeLabels([point], AREA, [across])).toEqual([boxAt(30, 30)]);
    expect(placeLabels([point], AREA, [AREA])).toEqual(placeLabels([point], AREA, []));
  });

  it('cover neither one another nor a point, and give way in order', () => {
    const crowd = Array.from({ length: 12 }, (_, i) => ({ x: 60 + i, y: 50 + i, ...size }));
    const boxes = placeLabels(crowd, AREA, []);
    expect(boxes[0]).not.toBeNull();
    expect(boxes).toContain(null);
    expectApart(boxes.filter((box) => box !== null));
    for (const [i, box] of boxes.entries()) {
      if (!box) continue;
      for (const [j, { x, y }] of crowd.entries()) {
        if (i === j) continue;
        expect(x > box.left && x < box.right && y > box.top && y < box.bottom).toBe(false);
      }
    }
  });

  it('all find a place on paper, apart, with leaders to points that are far', () => {
    const area = { left: 0, top: 0, right: 700, bottom: 400 };
    const labels = Array.from({ length: 20 }, (_, i) => ({
      x: 300 + 7 * i,
      y: 150 + 31 * (i % 4),
      width: 110,
      height: 13,
    }));
    const placed = placeAllLabels(labels, area, []);
    expect(placed).toHaveLength(labels.length);
    expectApart(placed.map(({ box }) => box));
    expect(placed[0].leader).toBeNull();
    for (const [i, { leader }] of placed.entries())
      if (leader) expect(leader.slice(0, 2)).toEqual([labels[i].x, labels[i].y]);
    expect(placed.some(({ leader }) => leader)).toBe(true);
  });
});
