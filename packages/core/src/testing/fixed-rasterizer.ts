/**
 * Accuracy for pictures that are compared bit by bit: views choose the rasteriser by its time, and
 * the two do not give the same bits.
 */
export const FIXED_RASTERIZER = { preset: 'balanced', rasterizer: 'quads' } as const;
