import type { LeafFile, LeafLevel, LeafScene, SceneLeaf, SplatCells } from '../data/bricks/leaf-scene.ts';

/** The pieces of one level of a leaf, of a file or of the scene's file that has it. */
export async function piecesOf(
  from: LeafScene | LeafFile,
  leaf: SceneLeaf,
  level: LeafLevel,
  signal?: AbortSignal,
): Promise<SplatCells[]> {
  const file = 'pack' in from ? from : await from.read(level.file);
  const [pieces] = await file.pack([{ leaf, level }], signal);
  return pieces;
}
