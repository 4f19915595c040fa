import { columnGlb } from './column.ts';
import { figurePly, figuresPly } from './figures.ts';
import { knotPly } from './knot.ts';
import { meadowPly } from './meadow.ts';
import { ringPly } from './ring.ts';
import { terrainPly } from './terrain.ts';
import { wavePly } from './waves.ts';

// At module level: its dynamic imports resolve only while this module is being imported.
const column = await columnGlb();

/** Generated scenes, by file name. */
const MADE: Readonly<Record<string, () => Uint8Array>> = {
  'ring.ply': ringPly,
  'column.glb': () => column,
  'knot.ply': knotPly,
  'terrain.ply': terrainPly,
  'meadow.ply': meadowPly,
  'figure.ply': figurePly,
  'figures.ply': figuresPly,
};

/** @param frames number of files in the sequence `wave-0.ply` and so on. */
export function madeScene(name: string, frames: number): Uint8Array {
  const [, frame] = /^wave-(\d+)\.ply$/.exec(name) ?? [];
  return frame === undefined ? MADE[name]() : wavePly(Number(frame) / frames);
}
