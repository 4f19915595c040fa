// Proves: walking to a wall and not through it; scenes without ground, and that stream.
import { encodePly, type SplatSet } from '@websplatter/core';
import { writeSplats } from '@websplatter/core/write';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { testScene } from './test-scene.ts';
import {
  CHEAPLY,
  clickInTurn,
  type DrawnCamera,
  drawnCamera,
  isAtRestAfter,
  redraw,
  textOf,
  viewerHarness,
  waitForNotice,
} from './viewer-page.ts';

/** Metres between splats, which are as wide. */
const SPACING = 0.2;
/** Each cell of a made mesh is so long, for eyes at 1.6 m. */
const CELL = 0.125;
const WALL_Z = -2;
const FLOOR = [
  [-4, 4],
  [0, 0],
  [-4, 4],
] as const;
const WALL = [
  [-4, 4],
  [0, 3],
  [WALL_Z, WALL_Z],
] as const;
/** A hollow block on the floor, without an underside. */
const BLOCK = { half: 1, height: 2 };
const STATUE = [
  ...[-BLOCK.half, BLOCK.half].flatMap((side) => [
    [
      [side, side],
      [0, BLOCK.height],
      [-BLOCK.half, BLOCK.half],
    ] as const,
    [
      [-BLOCK.half, BLOCK.half],
      [0, BLOCK.height],
      [side, side],
    ] as const,
  ]),
  [
    [-BLOCK.half, BLOCK.half],
    [BLOCK.height, BLOCK.height],
    [-BLOCK.half, BLOCK.half],
  ] as const,
];

/** Flat splats on rectangles, each thin along the axis on which it has no extent. */
function sheets(...ranges: readonly (readonly (readonly [from: number, to: number])[])[]): SplatSet {
  const rows = ranges.flatMap((range) => {
    const [x, y, z] = range.map(([from, to]) =>
      Array.from({ length: Math.round((to - from) / SPACING) + 1 }, (_, i) => from + i * SPACING),
    );
    const scales = range.map(([from, to]) => Math.log(from === to ? 0.01 : SPACING));
    return x.flatMap((a) => y.flatMap((b) => z.map((c) => ({ position: [a, b, c], scales }))));
  });
  const { origin, harmonics, dropped } = testScene(1);
  const count = rows.length;
  return {
    count,
    origin,
    dropped,
    positions: Float32Array.from(rows.flatMap(({ position }) => position)),
    logScales: Float32Array.from(rows.flatMap(({ scales }) => scales)),
    rotations: Float32Array.from({ length: 4 * count }, (_, i) => (i % 4 === 0 ? 1 : 0)),
    opacityLogits: new Float32Array(count).fill(4),
    colorDc: Float32Array.from(
      rows.flatMap(({ position: [a, b, c] }) => [Math.sin(3 * a), Math.sin(2 * c), b]),
    ),
    harmonics: { ...harmonics, coefficients: new Float32Array(9 * count) },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
  };
}

const harness = viewerHarness({
  'room.ply': encodePly(sheets(FLOOR, WALL)),
  'statue.ply': encodePly(sheets(FLOOR, ...STATUE)),
  'wall.ply': encodePly(sheets(WALL)),
  'city.bricks': await writeSplats(testScene(40_000), 'bricks'),
});
const WINDOW = { viewport: { width: 480, height: 320 } };
/** Within the scene, four metres before the wall, and looking at it. */
const CAMERA = `camera=0,2.4,0,2,0,${Math.PI / 2}`;

function positionOf({ viewMatrix: v }: DrawnCamera): number[] {
  return [0, 1, 2].map((axis) => -(v[4 * axis] * v[12] + v[4 * axis + 1] * v[13] + v[4 * axis + 2] * v[14]));
}

const position = async (page: Page) => positionOf(await drawnCamera(page));

/** Holds a key for some frames, and returns where the camera is at rest then, if it moved or not. */
async function held(page: Page, key: string, frames: number): Promise<number[]> {
  await page.keyboard.down(key);
  await page.evaluate(async (count) => {
    for (let i = 0; i < count; i++) await new Promise(requestAnimationFrame);
  }, frames);
  await page.keyboard.up(key);
  await page.waitForFunction(isAtRestAfter, 0);
  return position(page);
}

describe('walking in the viewer', () => {
  it('walks to a wall and not through it, at the height of the eyes, stays there, and can be called off', async () => {
    const page = await harness.shareViewer(`?src=room.ply&${CAMERA}&${CHEAPLY}`, WINDOW);
    await redraw(page, () => page.keyboard.press('b'));
    expect(await textOf(page, 'travel')).toContain('Walking');
    const [x, height, z] = await position(page);
    expect(x).toBeCloseTo(0, 9);
    expect(z).toBeCloseTo(2, 9);
    // The mesh lies up to a cell above the floor.
    expect(height).toBeGreaterThan(1.6);
    expect(height).toBeLessThan(1.6 + CELL);

    let place = [x, height, z];
    for (let before = Number.POSITIVE_INFINITY; before - place[2] > 0.01; ) {
      before = place[2];
      place = await held(page, 'w', 20);
      expect(Math.abs(place[1] - height)).toBeLessThan(CELL / 2);
    }
    // The body's radius before the mesh of the wall.
    expect(place[2]).toBeGreaterThan(WALL_Z + 0.25);
    expect(place[2]).toBeLessThan(WALL_Z + 0.25 + 1.5 * CELL);
    const [along] = await held(page, 'ArrowRight', 5);
    expect(along).toBeGreaterThan(0.05);

    const jumped = await held(page, 'Space', 3);
    expect(jumped[1]).toBeCloseTo(height, 1);
    // A person half as high.
    await redraw(page, () => page.getByTestId('eye-height').fill('0.8'));
    const [, low] = await position(page);
    expect(low).toBeGreaterThan(0.8);
    expect(low).toBeLessThan(0.8 + CELL);

    const before = await position(page);
    await page.keyboard.press('Escape');
    await page.getByTestId('travel').waitFor({ state: 'detached' });
    expect(await page.evaluate(() => document.pointerLockElement)).toBeNull();
    expect(await position(page)).toEqual(before);

    // The other way up there is other ground to find; what finds it can be called off.
    await redraw(page, () => page.keyboard.press('u'));
    const turned = await position(page);
    await redraw(page, () => page.keyboard.press('v'));
    await clickInTurn(page, 'walk', 'cancel-ground');
    await page.getByTestId('ground').waitFor({ state: 'detached' });
    expect(await page.getByTestId('travel').count()).toBe(0);
    expect(await position(page)).toEqual(turned);
  });

  it('begins in front of an object, not in it', async () => {
    const page = await harness.shareViewer(`?src=statue.ply&camera=0,1,0,9,0,1.25&${CHEAPLY}`, WINDOW);
    await redraw(page, () => page.keyboard.press('b'));
    expect(await textOf(page, 'travel')).toContain('Walking');
    const [x, , z] = await position(page);
    expect(x).toBeCloseTo(0, 9);
    expect(z).toBeGreaterThan(BLOCK.half);
    expect(z).toBeLessThan(FLOOR[2][1] + SPACING);
  });

  it('flies where there is no ground, and says why it cannot walk where splats stream', async () => {
    const page = await harness.shareViewer(`?src=wall.ply&${CAMERA}&${CHEAPLY}`, WINDOW);
    await page.keyboard.press('b');
    await waitForNotice(page, 'no ground');
    expect(await textOf(page, 'travel')).toContain('Flying');
    const streaming = await harness.shareViewer(`?url=city.bricks&${CHEAPLY}`, WINDOW);
    await streaming.keyboard.press('b');
    await waitForNotice(streaming, 'this scene streams');
    expect(await streaming.getByTestId('travel').count()).toBe(0);
  });
});
