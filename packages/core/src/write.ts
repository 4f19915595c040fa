/**
 * Changing splats and writing them as files (`@websplatter/core/write`), apart from the engine:
 * pages that only show splats do not download it.
 *
 * @module
 */

export {
  type CropBox,
  cropPiece,
  cropSplats,
  filterSplats,
  nothingLeft,
} from './data/editing/crop-splats.ts';
export { gradeSplats } from './data/editing/grade-splats.ts';
export { limitDegree } from './data/editing/limit-degree.ts';
export { mergeSplats } from './data/editing/merge-splats.ts';
export {
  AXIS_NAMES,
  multiplyQuaternions,
  type Quaternion,
  rotationByDegrees,
  rotationMatrixOf,
  uprightRotation,
} from './data/editing/quaternion.ts';
export { type SplatTransform, transformSplats } from './data/editing/transform-splats.ts';
export type { GradeOptions } from './data/math/grade-matrix.ts';
export { splatsAt } from './features/motion/splats-at.data.ts';
export type { FramingOptions } from './framing/framing-wishes.ts';
export { SplatFramer } from './framing/splat-framer.ts';
export { zipFiles } from './io/containers/write-zip.ts';
export type { BrickResult, BrickTask } from './io/formats/bricks/brick-tasks.ts';
export type { BrickWriter, BrickWriterOptions } from './io/formats/bricks/brick-writer.ts';
export { brickTaskBuffers } from './io/formats/bricks/task-buffers.ts';
export type { MakeTemporaryFile, TemporaryFile } from './io/formats/bricks/temporary-files.ts';
export type { WritableFormat } from './io/formats/formats.ts';
export type { FrameWriter, FrameWriterOptions } from './io/formats/frames/frame-writer.ts';
export { PieceFacts } from './io/formats/rows/piece-facts.ts';
export type { PartAddress } from './io/formats/sog/image-addresses.ts';
export { WRITABLE_FORMATS, writableByName } from './io/formats/writable-formats.ts';
export type { PutBytes, SplatPieces, WriteOptions } from './io/formats/write-format.ts';
export {
  canWritePieces,
  openBrickWriter,
  openFrameWriter,
  runBrickTask,
  sogImageAddresses,
  writeSplatPieces,
  writeSplats,
} from './io/formats/writers.ts';
export { readSplatPieces } from './io/loading/read-splats.ts';
/** @internal For other packages of this repository. */
export { Remote, RemotePool, serve } from './io/remote.ts';
