import { expect, onTestFinished, test } from 'vitest';
import type { CloudSight } from './cloud-sight.ts';
import { SceneViewers } from './scene-viewers.ts';

const CUT = { camera: [0, 0, 2], squaredPerDistance: 1e-9, leastSquared: 1e-12, margin: 0 } as const;
const side = () => ({ normal: [1, 0, 0], offset: 1, reach: 3 }) as const;
/** New objects, as each frame makes. */
const sight = (cut: Partial<CloudSight['cut']> = {}, squaredShift = 1): CloudSight => ({
  cut: { ...CUT, ...cut },
  squaredShift,
  sides: [side()],
});

test('sights are the same arrays until a view sees something else, so that plans stay', () => {
  const views = new SceneViewers(
    async () => {},
    () => {},
  );
  onTestFinished(() => views.end());
  const view = {};
  const after = (next: CloudSight) => {
    views.set(view, [next], async () => {});
    return [views.sights, views.predicted];
  };
  const [sights, predicted] = after(sight());
  for (let frame = 0; frame < 3; frame++) {
    const [next, nextPredicted] = after(sight());
    expect(next).toBe(sights);
    expect(nextPredicted).toBe(predicted);
  }
  for (const other of [sight({ squaredPerDistance: 1 }), sight({}, 2), sight({ camera: [0, 0, 3] })]) {
    const [before] = after(sight());
    expect(after(other)[0]).not.toBe(before);
  }
});
