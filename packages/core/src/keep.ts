/**
 * Scenes of any size from a disk (`@websplatter/core/keep`), apart from the engine: a first picture
 * of some splats of a PLY, and all of it arranged for streaming, where the browser keeps it.
 */
export { type KeepOptions, keepBricks, keptBricks } from './io/keep/keep-bricks.ts';
export { type KeptScene, keptScenes, removeKept, StorageRoomError } from './io/keep/kept-scenes.ts';
export { type SamplePlyOptions, samplePly } from './io/keep/sample-ply.ts';
