import type { ColorTarget, RecordPrecision } from '../accuracy.ts';
import type { RenderState, StageDefinition } from '../gpu/pipelines.ts';

/** Draws the visible splats back to front. */
export function rasterize(recordPrecision: RecordPrecision) {
  return {
    stage: 'rasterize',
    conditions: { RECORD_F32: recordPrecision === 'f32' },
    bindings: { view: [0, 'uniform'], order: [1, 'read'], projected: [2, 'read'] },
  } as const satisfies StageDefinition;
}

/** Premultiplied "over". */
export function rasterizeState(format: ColorTarget): RenderState {
  const over = { srcFactor: 'one', dstFactor: 'one-minus-src-alpha', operation: 'add' } as const;
  return { format, topology: 'triangle-strip', blend: { color: over, alpha: over } };
}
