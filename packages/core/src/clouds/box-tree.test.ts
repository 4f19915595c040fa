import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { uniform } from '../testing/uniform.ts';
import { BoxTree } from './box-tree.ts';

type Triple = readonly [number, number, number];

const triple = (value: fc.Arbitrary<number>): fc.Arbitrary<Triple> => fc.tuple(value, value, value);
/** Whole numbers too, so that rays run along faces and begin on corners. */
const coordinate = fc.oneof(uniform(-4, 4), fc.integer({ min: -4, max: 4 }));
const boxes = fc.array(fc.tuple(triple(coordinate), triple(fc.oneof(uniform(0, 2), fc.constantFrom(0, 1)))), {
  maxLength: 100,
  size: 'max',
});

const treeOf = (list: readonly (readonly [Triple, Triple])[]) =>
  new BoxTree(
    Float64Array.from(list.flatMap(([min, size]) => [...min, ...min.map((low, axis) => low + size[axis])])),
  );

/** The definition, box by box: the smallest t ≥ 0 at which the ray is inside any box. */
function entryByDefinition(list: readonly (readonly [Triple, Triple])[], origin: Triple, direction: Triple) {
  let nearest = Number.POSITIVE_INFINITY;
  for (const [min, size] of list) {
    const spans = [0, 1, 2].map((axis): [number, number] => {
      const [low, high] = [min[axis], min[axis] + size[axis]];
      if (direction[axis] === 0)
        return origin[axis] >= low && origin[axis] <= high ? [0, Infinity] : [Infinity, -Infinity];
      const ends = [low, high].map((end) => (end - origin[axis]) / direction[axis]);
      return [Math.min(...ends), Math.max(...ends)];
    });
    const enter = Math.max(0, ...spans.map(([from]) => from));
    if (enter <= Math.min(...spans.map(([, to]) => to))) nearest = Math.min(nearest, enter);
  }
  return nearest;
}

describe('a tree of boxes', () => {
  test('finds the same box as testing every box', () => {
    let hits = 0;
    fc.assert(
      fc.property(boxes, triple(coordinate), triple(coordinate), (list, origin, direction) => {
        const { distance } = treeOf(list).nearestEntry(origin, direction);
        if (distance < Infinity) hits++;
        expect(distance).toBe(entryByDefinition(list, origin, direction));
      }),
      { numRuns: 2000 },
    );
    expect(hits).toBeGreaterThan(200);
  });

  test('inside of a box, and on its face, the distance is 0', () => {
    const tree = treeOf([
      [
        [0, 0, 0],
        [1, 1, 1],
      ],
    ]);
    expect(tree.nearestEntry([0.5, 0.5, 0.5], [0, 0, 1]).distance).toBe(0);
    expect(tree.nearestEntry([0.5, 0.5, 1], [0, 0, 1]).distance).toBe(0);
    expect(tree.nearestEntry([0.5, 0.5, 1.001], [0, 0, 1]).distance).toBe(Infinity);
    // A direction of length 0 stays at its origin.
    expect(tree.nearestEntry([0.5, 0.5, 0.5], [0, 0, 0]).distance).toBe(0);
    expect(tree.nearestEntry([2, 0.5, 0.5], [0, -0, 0]).distance).toBe(Infinity);
  });

  test('rays with non-finite components find nothing, and do not throw', () => {
    const tree = treeOf([
      [
        [-1e30, -1, -1],
        [2e30, 2, 2],
      ],
    ]);
    const odd = [Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    for (const value of odd) {
      for (const axis of [0, 1, 2]) {
        const broken = [0.1, 0.2, 0.3].map((v, i) => (i === axis ? value : v));
        expect(tree.nearestEntry(broken, [1, 0, 0]).distance).toBe(Infinity);
        expect(tree.nearestEntry([0, 0, 0], broken).distance).toBe(Infinity);
      }
    }
    for (const size of [5e-324, 1e-310, 1e300, 1.7e308]) {
      expect(tree.nearestEntry([size, 0, 0], [-size, 0, 0]).distance).not.toBeNaN();
      expect(tree.nearestEntry([1e30, 3, 0], [0, -size, size]).distance).not.toBeNaN();
    }
    expect(new BoxTree(new Float64Array()).nearestEntry([0, 0, 0], [1, 0, 0])).toEqual({
      distance: Infinity,
      testedBoxes: 0,
    });
  });
});
