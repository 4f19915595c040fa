/**
 * Sequences of files, played as frames, by a hook.
 *
 * @module
 */
'use client';

// The class and its helper for applications that install only this package.
export {
  type FrameLoader,
  inPathOrder,
  SplatSequence,
  type SplatSequenceEventMap,
  type SplatSequenceOptions,
} from '@websplatter/three/sequence';
export {
  type SplatSequenceState,
  type UseSplatSequenceOptions,
  useSplatSequence,
} from './use-splat-sequence.ts';
