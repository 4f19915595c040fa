import dilatedBlob from '../../../../../shaders/lib/dilated-blob.wgsl?raw';
import instances from '../../../../../shaders/lib/instances.wgsl?raw';
import levelLink from '../../../../../shaders/lib/level-link.wgsl?raw';
import mergedCell from '../../../../../shaders/lib/merged-cell.wgsl?raw';
import mergedSplat from '../../../../../shaders/lib/merged-splat.wgsl?raw';
import cullChunks from '../../../../../shaders/stages/cull-chunks.wgsl?raw';
import cullSplats from '../../../../../shaders/stages/cull-splats.wgsl?raw';
import cutCells from '../../../../../shaders/stages/cut-cells.wgsl?raw';
import cutCount from '../../../../../shaders/stages/cut-count.wgsl?raw';
import cutSplats from '../../../../../shaders/stages/cut-splats.wgsl?raw';
import mergeChunks from '../../../../../shaders/stages/merge-chunks.wgsl?raw';
import mergeHarmonics from '../../../../../shaders/stages/merge-harmonics.wgsl?raw';
import openLeaves from '../../../../../shaders/stages/open-leaves.wgsl?raw';
import planCut from '../../../../../shaders/stages/plan-cut.wgsl?raw';
import project from '../../../../../shaders/stages/project.wgsl?raw';
import touchLinks from '../../../../../shaders/stages/touch-links.wgsl?raw';
import { PACKING_LIBRARIES } from '../stages/packing-libraries.ts';

/** Texts of the stages that make or draw levels of detail, or draw instances. */
export const LEVEL_TEXTS = {
  'cull-chunks': cullChunks,
  'cull-splats': cullSplats,
  'cut-cells': cutCells,
  'cut-count': cutCount,
  'cut-splats': cutSplats,
  'merge-chunks': mergeChunks,
  'merge-harmonics': mergeHarmonics,
  'open-leaves': openLeaves,
  'plan-cut': planCut,
  project,
  'touch-links': touchLinks,
} as const;

/** Modules that only the stages above import, and no stage in the engine's own code. */
export const LEVEL_LIBRARIES = {
  ...PACKING_LIBRARIES,
  'lib/dilated-blob': dilatedBlob,
  'lib/instances': instances,
  'lib/level-link': levelLink,
  'lib/merged-cell': mergedCell,
  'lib/merged-splat': mergedSplat,
} as const;
