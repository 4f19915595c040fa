import { ACCURACY_PRESETS, InvalidArgumentError } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { benchmarkRequest } from './request.ts';

const read = (query: string) => benchmarkRequest(new URLSearchParams(query));

describe('the benchmark that an address asks for', () => {
  it('is the same on every device where the address says nothing', () => {
    expect(read('bench')).toEqual({
      widthPx: 1920,
      heightPx: 1080,
      frames: 100,
      orbitDegrees: 15,
      accuracy: ACCURACY_PRESETS.balanced,
      accuracyLabel: 'balanced',
    });
  });

  it('takes size, frames, angle and settings', () => {
    expect(read('bench&size=640x360&frames=8&orbit=360&accuracy=fast')).toEqual({
      widthPx: 640,
      heightPx: 360,
      frames: 8,
      orbitDegrees: 360,
      accuracy: ACCURACY_PRESETS.fast,
      accuracyLabel: 'fast',
    });
    expect(read('size=8×4')).toMatchObject({ widthPx: 8, heightPx: 4 });
    expect(read('accuracy=fast,sortKeyBits:32').accuracy).toEqual({
      ...ACCURACY_PRESETS.fast,
      sortKeyBits: 32,
    });
    expect(read('accuracy=rasterizer:quads').accuracy.rasterizer).toBe('quads');
  });

  /**
   * @fault Arguments: a benchmark's URL asks for something unknown
   * @consequence nothing is measured, and the page says what to write
   */
  it.each([
    ['size=640', 'size is 640;'],
    ['size=0x10', 'size is 0x10;'],
    ['size=99999x10', 'size is 99999x10;'],
    ['frames=0', 'frames is 0;'],
    ['frames=1.5', 'frames is 1.5;'],
    ['frames=', 'frames is ;'],
    ['orbit=0', 'orbit is 0;'],
    ['orbit=361', 'orbit is 361;'],
    ['accuracy=minPsnrDb:45', 'settings that are the same on every device'],
    ['accuracy=nonsense', 'nonsense'],
  ])('refuses %s in words', (query, message) => {
    expect(() => read(query)).toThrow(InvalidArgumentError);
    expect(() => read(query)).toThrow(message);
  });
});
