import layerRounding from '../../../../../shaders/lib/layer-rounding.wgsl?raw';
import splatEllipse from '../../../../../shaders/lib/splat-ellipse.wgsl?raw';
import tileGrid from '../../../../../shaders/lib/tile-grid.wgsl?raw';
import workgroupScan from '../../../../../shaders/lib/workgroup-scan.wgsl?raw';
import tileCount from '../../../../../shaders/stages/tile-count.wgsl?raw';
import tileEmit from '../../../../../shaders/stages/tile-emit.wgsl?raw';
import tileMasks from '../../../../../shaders/stages/tile-masks.wgsl?raw';
import tilePlan from '../../../../../shaders/stages/tile-plan.wgsl?raw';
import tileRanges from '../../../../../shaders/stages/tile-ranges.wgsl?raw';
import tileRasterize from '../../../../../shaders/stages/tile-rasterize.wgsl?raw';

/** Texts of stages that only tiles need; `tileSource` loads them in parallel to the engine's own code. */
export const TILE_TEXTS = {
  'tile-count': tileCount,
  'tile-emit': tileEmit,
  'tile-masks': tileMasks,
  'tile-plan': tilePlan,
  'tile-ranges': tileRanges,
  'tile-rasterize': tileRasterize,
} as const;

/** Modules that only the stages above import, and no stage in the engine's own code. */
export const TILE_LIBRARIES = {
  'lib/layer-rounding': layerRounding,
  'lib/splat-ellipse': splatEllipse,
  'lib/tile-grid': tileGrid,
  'lib/workgroup-scan': workgroupScan,
} as const;
