import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Refines cuts around splats that are drawn one by one, in the cells of a page. */
export const touchLinks: StageDefinition = /* @__PURE__ */ computeStage('touch-links', {
  source: levelSource('touch-links'),
  constants: LEVEL_CONSTANTS,
});

/** The same, in the cells of a level above the chunks. */
export const touchUpperLinks: StageDefinition = { ...touchLinks, conditions: { UPPER: true } };
