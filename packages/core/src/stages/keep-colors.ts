import type { RecordPrecision } from '../accuracy/accuracy.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { rareSource } from '../shaders/later-source.ts';
import { recordConditions } from './record-conditions.ts';

/** Keeps the colours that a page's splats were drawn with. */
export function keepColors(recordPrecision: RecordPrecision): StageDefinition {
  return {
    stage: 'keep-colors',
    source: rareSource('keep-colors'),
    entryPoint: 'keepColors',
    conditions: recordConditions(recordPrecision),
    bindings: {
      view: [0, 'uniform'],
      page: [1, 'uniform'],
      pagePlans: [2, 'read'],
      visibleSplats: [3, 'read'],
      records: [4, 'read'],
      keptColors: [5, 'read-write'],
    },
  };
}
