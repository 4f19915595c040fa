/**
 * The preset `reference` with keys of 32 bits, for tests that compare images and have no near ties of
 * depth: keys of 64 bits take twice as many passes, and shaders of their own. By one rasteriser: views
 * choose it by its time, the two do not give the same bits, and both would be compiled.
 */
export const NARROW_REFERENCE = { preset: 'reference', sortKeyBits: 32, rasterizer: 'tiles' } as const;
