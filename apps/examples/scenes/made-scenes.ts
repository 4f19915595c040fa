import { columnGlb } from './column.ts';
import { ringPly } from './ring.ts';

/** Scenes that code makes, by the names of their files. */
export const madeScenes: Readonly<Record<string, Uint8Array>> = {
  'ring.ply': ringPly(),
  // Here and not in a function: what it imports later is there only while this module is imported.
  'column.glb': await columnGlb(),
};
