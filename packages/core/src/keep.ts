/**
 * Scenes of any size from a disk (`@websplatter/core/keep`), apart from the engine: previews of a
 * PLY, and its conversion to a streamable file in the browser's storage (OPFS).
 *
 * @module
 */
export { type KeepOptions, keepBricks, keptBricks } from './io/keep/keep-bricks.ts';
export { type KeptScene, keptScenes, removeKept, StorageRoomError } from './io/keep/kept-scenes.ts';
export { type SamplePlyOptions, samplePly } from './io/keep/sample-ply.ts';
