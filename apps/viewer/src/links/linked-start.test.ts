import { describe, expect, it } from 'vitest';
import { linkedStart } from './linked-start.ts';

describe('the start from a link', () => {
  it('is nothing where the address tells nothing', () => {
    expect(linkedStart(new URLSearchParams('scene=still-life'))).toEqual({
      camera: null,
      comparison: null,
      notice: null,
    });
  });

  it('has the camera and the comparison of the address', () => {
    const { camera, comparison, notice } = linkedStart(
      new URLSearchParams('camera=0,0,0,2,0,1&compare=error'),
    );
    expect(camera?.pose.distance).toBe(2);
    expect(comparison?.comparison.kind).toBe('error');
    expect(notice).toBeNull();
  });

  it('leaves out what cannot be read, and says so', () => {
    const { camera, comparison, notice } = linkedStart(new URLSearchParams('camera=near&compare=fast/high'));
    expect(camera).toBeNull();
    expect(comparison?.comparison.kind).toBe('split');
    expect(notice).toContain('“near” is no number');
  });
});
