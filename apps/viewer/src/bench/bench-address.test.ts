import { describe, expect, it } from 'vitest';
import { benchAddress, viewerAddress } from './bench-address.ts';

describe('addresses between viewer and benchmark', () => {
  it('keep scene and accuracy, and leave out what only one of them reads', () => {
    const viewer = new URLSearchParams('src=a.ply&src=b.ply&accuracy=fast&camera=1,2,3&noui');
    expect(benchAddress(viewer)).toBe('?bench&src=a.ply&src=b.ply&accuracy=fast');
    const bench = new URLSearchParams('bench&scene=still-life&size=64x64&frames=4');
    expect(viewerAddress(bench)).toBe('?scene=still-life');
    expect(benchAddress(new URLSearchParams())).toBe('?bench');
    expect(viewerAddress(new URLSearchParams('bench'))).toBe('?');
  });
});
