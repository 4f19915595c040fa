import { orthographicCamera, perspectiveCamera } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import {
  lineInPicture,
  movedAlong,
  movedAway,
  movedInPicture,
  type PictureSpace,
  pathInPicture,
  pictureOf,
} from './picture-space.ts';

const place = { position: [1, 2, 8], target: [0, 0.5, 0], up: [0, 1, 0] } as const;
const depths = { near: 0.1, far: 100, aspect: 1.5 };
const size = { width: 300, height: 200 };
const spaces: [string, PictureSpace][] = [
  ['perspective', { camera: perspectiveCamera({ ...place, ...depths, fovYDegrees: 50 }), ...size }],
  ['orthographic', { camera: orthographicCamera({ ...place, ...depths, height: 6 }), ...size }],
];

describe.each(spaces)('a picture in %s', (_, space) => {
  it('has what the camera looks at in its middle', () => {
    const [x, y] = pictureOf(space, place.target) ?? [];
    expect(x).toBeCloseTo(150, 9);
    expect(y).toBeCloseTo(100, 9);
  });

  it('moves points by pixels', () => {
    const point = [0.7, -0.2, 0.4] as const;
    const [x, y] = pictureOf(space, point) ?? [];
    const [movedX, movedY] = pictureOf(space, movedInPicture(space, point, 30, -12)) ?? [];
    expect(movedX).toBeCloseTo(Number(x) + 30, 9);
    expect(movedY).toBeCloseTo(Number(y) - 12, 9);
  });

  it('moves points away, as far as pixels are long there', () => {
    const point = [0.7, -0.2, 0.4] as const;
    const away = movedAway(space, point, 10);
    const sideways = movedInPicture(space, point, 10, 0);
    const lengthOf = (moved: readonly number[]) => Math.hypot(...moved.map((v, i) => v - point[i]));
    expect(lengthOf(away)).toBeCloseTo(lengthOf(sideways), 9);
    expect(lengthOf(movedAway(space, away, -10).map((v, i) => v - away[i] + point[i]))).toBeCloseTo(
      lengthOf(away),
      1,
    );
    expect(away[2]).toBeLessThan(point[2]);
  });

  it('moves points along a direction with the pointer, and not with a pointer that goes across it', () => {
    const up = movedAlong(space, [0, 0, 0], [0, 1, 0], 0, -20);
    expect(up[1]).toBeGreaterThan(0);
    expect([up[0], up[2]]).toEqual([0, 0]);
    const [fromX, fromY] = pictureOf(space, [0, 0, 0]) ?? [0, 0];
    const [toX, toY] = pictureOf(space, [0, 1, 0]) ?? [0, 0];
    const across = movedAlong(space, [0, 0, 0], [0, 1, 0], toY - fromY, fromX - toX);
    expect(Math.hypot(...across)).toBeLessThan(0.02);
  });
});

describe('a line', () => {
  const camera = perspectiveCamera({
    ...place,
    position: [0, 0, 5],
    target: [0, 0, 0],
    ...depths,
    fovYDegrees: 90,
  });
  const space = { camera, ...size };

  it('ends at the near plane where it passes the camera, at either end', () => {
    // A unit is a thousand pixels long a tenth of a unit away.
    expect(lineInPicture(space, [1, 0, 0], [1, 0, 50])?.[1][0]).toBeCloseTo(1150, 6);
    expect(lineInPicture(space, [1, 0, 50], [1, 0, 0])?.[0][0]).toBeCloseTo(1150, 6);
  });

  it('is cut off where it passes the camera', () => {
    const line = lineInPicture(space, [1, 0, 0], [1, 0, 50]);
    expect(line?.flat().every(Number.isFinite)).toBe(true);
    expect(line?.[0]).toEqual(pictureOf(space, [1, 0, 0]));
  });

  it('is none behind the camera', () => {
    expect(lineInPicture(space, [1, 0, 20], [1, 0, 50])).toBeNull();
    expect(pictureOf(space, [0, 0, 6])).toBeNull();
    expect(
      pathInPicture(space, [
        [
          [1, 0, 20],
          [1, 0, 50],
        ],
      ]),
    ).toBe('');
  });

  it('becomes a path, point by point', () => {
    const path = pathInPicture(space, [
      [
        [0, 0, 0],
        [1, 0, 0],
        [1, 1, 0],
      ],
    ]);
    expect(path).toMatch(/^M150\.0 100\.0L\d+\.\d \d+\.\dM\d/);
  });

  it('straight away from the camera is moved along by going up', () => {
    expect(movedAlong(space, [0, 0, 0], [0, 0, -1], 0, -10)[2]).toBeLessThan(0);
  });
});
