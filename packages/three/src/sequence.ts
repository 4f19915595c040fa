/**
 * Sequences of files, played as frames (`@websplatter/three/sequence`).
 *
 * @module
 */
export {
  type FrameLoader,
  inPathOrder,
  SplatSequence,
  type SplatSequenceEventMap,
  type SplatSequenceOptions,
} from './cloud/splat-sequence.ts';
