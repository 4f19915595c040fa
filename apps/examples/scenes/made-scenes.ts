import { columnGlb } from './column.ts';
import { figurePly, figuresPly } from './figures.ts';
import { knotPly } from './knot.ts';
import { meadowPly } from './meadow.ts';
import { ringPly } from './ring.ts';
import { terrainPly } from './terrain.ts';
import { wavePly } from './waves.ts';

// Here and not in a function: what it imports later is there only while this module is imported.
const column = await columnGlb();

/** Scenes that code makes, by the names of their files. */
const MADE: Readonly<Record<string, () => Uint8Array>> = {
  'ring.ply': ringPly,
  'column.glb': () => column,
  'knot.ply': knotPly,
  'terrain.ply': terrainPly,
  'meadow.ply': meadowPly,
  'figure.ply': figurePly,
  'figures.ply': figuresPly,
};

/** @param frames number of the files of the sequence, `wave-0.ply` and so on. */
export function madeScene(name: string, frames: number): Uint8Array {
  const [, frame] = /^wave-(\d+)\.ply$/.exec(name) ?? [];
  return frame === undefined ? MADE[name]() : wavePly(Number(frame) / frames);
}
