import { describe, expect, it } from 'vitest';
import { FrameMeter } from './drawing.ts';

describe('FrameMeter', () => {
  it('has no pace for a lone frame', () => {
    expect(new FrameMeter().add(130)).toBeNull();
  });

  it('averages the time between completions', () => {
    const meter = new FrameMeter();
    meter.add(10);
    meter.add(30);
    expect(meter.add(50)).toEqual({ frameMs: 20, framesPerSecond: 50 });
  });

  it('does not count a pause as a slow frame', () => {
    const meter = new FrameMeter();
    meter.add(10);
    meter.pause();
    expect(meter.add(5010)).toBeNull();
    expect(meter.add(5030)).toEqual({ frameMs: 20, framesPerSecond: 50 });
  });

  it('forgets frames older than a second, but not the last but one', () => {
    const meter = new FrameMeter();
    meter.add(10);
    meter.add(510);
    expect(meter.add(2510)?.frameMs).toBe(2000);
  });
});
