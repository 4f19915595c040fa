import { describe, expect, it } from 'vitest';
import { placeLabels } from './place-labels.ts';

const AREA = { left: 0, top: 0, width: 200, height: 100 };
const size = { width: 40, height: 12 };

describe('names of points', () => {
  it('stand to the right where there is room', () => {
    expect(placeLabels([{ x: 50, y: 50, ...size }], AREA)).toEqual([{ left: 58, top: 44, ...size }]);
  });

  it('move to the left at the right edge, and below at the top', () => {
    const [atRight] = placeLabels([{ x: 190, y: 50, ...size }], AREA);
    expect(atRight).toEqual({ left: 142, top: 44, ...size });
    const [wide] = placeLabels([{ x: 100, y: 5, width: 120, height: 12 }], AREA);
    expect(wide).toEqual({ left: 40, top: 13, width: 120, height: 12 });
  });

  it('stand beside a line rather than on it, and on it rather than nowhere', () => {
    const point = { x: 50, y: 50, ...size };
    const across = { left: 0, top: 49, width: 200, height: 2 };
    expect(placeLabels([point], AREA, [across])).toEqual([{ left: 30, top: 30, ...size }]);
    expect(placeLabels([point], AREA, [AREA])).toEqual(placeLabels([point], AREA));
  });

  it('cover neither one another nor a point, and give way in order', () => {
    const crowd = Array.from({ length: 12 }, (_, i) => ({ x: 60 + i, y: 50 + i, ...size }));
    const boxes = placeLabels(crowd, AREA);
    expect(boxes[0]).not.toBeNull();
    expect(boxes).toContain(null);
    const placed = boxes.filter((box) => box !== null);
    for (const [i, a] of placed.entries()) {
      for (const b of placed.slice(i + 1)) {
        const apartX = a.left + a.width <= b.left || b.left + b.width <= a.left;
        const apartY = a.top + a.height <= b.top || b.top + b.height <= a.top;
        expect(apartX || apartY).toBe(true);
      }
    }
    for (const [i, box] of boxes.entries()) {
      if (!box) continue;
      for (const [j, { x, y }] of crowd.entries()) {
        if (i === j) continue;
        const isCovered = x > box.left && x < box.left + box.width && y > box.top && y < box.top + box.height;
        expect(isCovered).toBe(false);
      }
    }
  });
});
