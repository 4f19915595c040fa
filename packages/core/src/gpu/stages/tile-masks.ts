import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type TileListVariant, tileListConditions } from './tile-count.ts';

const { MASK_GROUP } = SHADER_CONSTANTS;

/**
 * Finds the tiles that each pair may touch.
 *
 * @param isNarrow the device's `hasNarrowSubgroups`.
 */
export function tileMasks(variant: TileListVariant, isNarrow = false): StageDefinition {
  return computeStage('tile-masks', {
    source: tileSource('tile-masks'),
    entryPoint: 'maskTiles',
    conditions: { ...tileListConditions(variant), NARROW: isNarrow },
    constants: { MASK_WORKGROUP: isNarrow ? MASK_GROUP / 32 : MASK_GROUP },
  });
}
