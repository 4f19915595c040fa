/**
 * Files of frames, opened for playback (`@websplatter/core/frames`).
 *
 * @module
 */
export { type OpenFramesOptions, openFrames, type SplatFrames } from './io/formats/frames/open-frames.ts';
