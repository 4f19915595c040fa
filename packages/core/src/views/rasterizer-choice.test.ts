import { describe, expect, test } from 'vitest';
import type { FrameRasterizer } from '../data/accuracy/accuracy.ts';
import type { RasterizeDepth } from '../stages/quads/quads.ts';
import { RasterizerChoice, type TimedFrame } from './rasterizer-choice.ts';

/** A device and view: times of both rasterisers, and of an empty pass, ms. */
interface Device {
  tilesMs: number;
  quadsMs: number;
  readonly passMs: number;
  /** Smallest step of its timestamps, ms. */
  readonly stepMs: number;
  visibleSplats: number;
}

const DEVICE: Device = { tilesMs: 1, quadsMs: 40, passMs: 0.005, stepMs: 0, visibleSplats: 1e6 };

const WRITTEN = { layerFormat: 'r32float' } as RasterizeDepth;

function choiceOn(options: { hasTimestamps?: boolean; remembered?: FrameRasterizer } = {}) {
  const remembered: FrameRasterizer[] = [];
  const choice = new RasterizerChoice({
    hasTimestamps: options.hasTimestamps ?? true,
    remembered: options.remembered ?? null,
    remember: (rasterizer) => remembered.push(rasterizer),
  });
  return { choice, remembered };
}

/** Draws frames on `device`; returns the time of each, samples included. */
function draw(choice: RasterizerChoice, device: Device, frames: number): number[] {
  const step = (ms: number) => (device.stepMs ? Math.round(ms / device.stepMs) * device.stepMs : ms);
  return Array.from({ length: frames }, () => {
    const { rasterizer, sampleShare } = choice;
    const sampleMs = sampleShare === null ? null : device.passMs + sampleShare * device.quadsMs;
    const elapsedMs = rasterizer === 'tiles' ? device.tilesMs : device.quadsMs;
    const frame: TimedFrame = {
      rasterizer,
      elapsedMs: step(elapsedMs),
      visibleSplats: device.visibleSplats,
      pixels: 2e6,
      sampleMs: sampleMs === null ? null : step(sampleMs),
    };
    choice.take(frame);
    return elapsedMs + (sampleMs ?? 0);
  });
}

describe('the choice of a rasteriser', () => {
  for (const stepMs of [0, 0.1]) {
    for (const [tilesMs, quadsMs] of [
      [0.5, 22],
      [1.5, 73],
      [1, 3],
      [300, 2400],
      [8, 30],
    ]) {
      test(`stays with tiles of ${tilesMs} ms beside quads of ${quadsMs} ms (timestamps by ${stepMs}), and hides the samples`, () => {
        const { choice, remembered } = choiceOn();
        const times = draw(choice, { ...DEVICE, tilesMs, quadsMs, stepMs }, 60);
        expect(Math.max(...times)).toBeLessThan(2 * tilesMs);
        expect(choice.report).toMatchObject({ rasterizer: 'tiles', tilesMs: expect.any(Number) });
        expect(choice.report.quadsMs).toBeGreaterThan(choice.report.tilesMs!);
        expect(remembered).toEqual(['tiles']);
      });
    }
  }

  test('knows the time of quads, however long a pass takes that draws nothing', () => {
    for (const passMs of [0.001, 15]) {
      const { choice } = choiceOn();
      draw(choice, { ...DEVICE, tilesMs: 150, quadsMs: 430, passMs }, 60);
      expect(choice.report.quadsMs).toBeCloseTo(430, 6);
    }
  });

  test('changes to quads where they are faster', () => {
    const { choice, remembered } = choiceOn();
    const times = draw(choice, { ...DEVICE, tilesMs: 12, quadsMs: 5 }, 60);
    expect(choice.rasterizer).toBe('quads');
    expect(choice.report.reason).toBe('on this device and view tiles took 12 ms and quads 5 ms');
    expect(times.slice(20)).toEqual(times.slice(20).map(() => 5));
    expect(remembered).toEqual(['quads']);
  });

  test('returns from quads that promised more than they keep', () => {
    const { choice } = choiceOn();
    const device = { ...DEVICE, tilesMs: 10, quadsMs: 4 };
    while (choice.rasterizer === 'tiles') draw(choice, device, 1);
    device.quadsMs = 14;
    draw(choice, device, 20);
    expect(choice.report).toMatchObject({ rasterizer: 'tiles', tilesMs: 10, quadsMs: 14 });
  });

  test('compares again when the load has moved, and not before', () => {
    const { choice } = choiceOn();
    const device = { ...DEVICE };
    draw(choice, device, 200);
    expect(choice.sampleShare).toBeNull();
    Object.assign(device, { visibleSplats: 1e5, tilesMs: 0.9, quadsMs: 0.3 });
    draw(choice, device, 200);
    expect(choice.rasterizer).toBe('quads');
    Object.assign(device, { visibleSplats: 1e6, tilesMs: 1, quadsMs: 40 });
    draw(choice, device, 200);
    expect(choice.rasterizer).toBe('tiles');
  });

  test('begins with the one that was faster before', () => {
    const { choice } = choiceOn({ remembered: 'quads' });
    expect(choice.rasterizer).toBe('quads');
    draw(choice, { ...DEVICE, tilesMs: 9, quadsMs: 6 }, 40);
    expect(choice.rasterizer).toBe('quads');
    draw(choice, { ...DEVICE, tilesMs: 1, quadsMs: 20, visibleSplats: 3e6 }, 100);
    expect(choice.rasterizer).toBe('tiles');
  });

  test('compares whole frames without timestamps', () => {
    const { choice } = choiceOn({ hasTimestamps: false });
    draw(choice, { ...DEVICE, tilesMs: 12, quadsMs: 5 }, 40);
    expect(choice.rasterizer).toBe('quads');
    expect(choice.sampleShare).toBeNull();
  });

  test('leaves views that tiles cannot draw to quads, until the load has moved', () => {
    const { choice } = choiceOn();
    expect(choice.rasterizerFor(WRITTEN)).toBe('tiles');
    choice.rejectTiles('no room', { visibleSplats: 1e6, pixels: 2e6 });
    expect(choice.rasterizerFor(WRITTEN)).toBe('quads');
    draw(choice, DEVICE, 200);
    expect(choice.report).toMatchObject({ rasterizer: 'quads', reason: 'no room' });
    draw(choice, { ...DEVICE, visibleSplats: 1e5 }, 100);
    expect(choice.rasterizer).toBe('tiles');
    expect(choice.rasterizerFor(WRITTEN)).toBe('tiles');
  });

  test('has tiles write depth, though quads were the faster', () => {
    const { choice } = choiceOn({ remembered: 'quads' });
    expect([choice.rasterizer, choice.rasterizerFor(WRITTEN)]).toEqual(['quads', 'tiles']);
  });

  test('ignores late times of the one that no longer draws', () => {
    const { choice } = choiceOn({ remembered: 'quads' });
    const late: TimedFrame = {
      rasterizer: 'tiles',
      elapsedMs: 1,
      visibleSplats: 1,
      pixels: 1,
      sampleMs: null,
    };
    for (let i = 0; i < 10; i++) choice.take(late);
    expect(choice.report.tilesMs).toBeNull();
  });
});
