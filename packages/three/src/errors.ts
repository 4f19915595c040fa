import { WebSplatterError } from '@websplatter/core';
import { REVISION } from 'three/webgpu';

/** The renderer cannot draw splats: it is not a WebGPURenderer that draws with WebGPU. */
export class SplatsUnsupportedRendererError extends WebSplatterError {
  override readonly name = 'SplatsUnsupportedRendererError';
  constructor(message: string) {
    super('unsupported-renderer', message);
  }
}

/**
 * Splats are drawn less exactly than requested, or use more memory than necessary: `cause` says
 * why. The image stays as it was.
 */
export class SplatsPrecisionError extends WebSplatterError {
  override readonly name = 'SplatsPrecisionError';
  constructor(cause: Error) {
    super('precision-unavailable', `Splats keep their present precision. ${cause.message}`, { cause });
  }
}

/**
 * Parts of a streamed scene could not be fetched: see `cause`. Fetched parts are drawn; `retry`
 * fetches the missing ones.
 */
export class SplatsStreamError extends WebSplatterError {
  override readonly name = 'SplatsStreamError';
  readonly retry: () => void;
  constructor(cause: Error, retry: () => void) {
    super('stream-interrupted', `Parts of a scene are missing. ${cause.message}`, { cause });
    this.retry = retry;
  }
}

/** Splats cannot be drawn into one of three's passes, because that pass cannot be interrupted. */
export class SplatsPassError extends WebSplatterError {
  override readonly name = 'SplatsPassError';
  constructor(message: string) {
    super('unsupported-pass', message);
  }
}

/** This release of three does not keep its renderer's state where the supported releases do. */
export class ThreeInternalsError extends WebSplatterError {
  override readonly name = 'ThreeInternalsError';
  /** Path of the missing property, e.g. `renderer.backend.get`. */
  readonly missing: string;
  /** three's `REVISION`. */
  readonly revision: string;

  constructor(missing: string, revision: string) {
    super(
      'three-internals',
      `three r${revision} has no ${missing}, which drawing splats needs. ` +
        `Install ${TESTED_RANGE} or a newer @websplatter/three.`,
    );
    this.missing = missing;
    this.revision = revision;
  }
}

/** Releases of three, `0.N.x`, that tests draw with: the oldest and the newest. */
export const TESTED_RELEASES = { oldest: 185, newest: 187 } as const;

/** The same in words. */
const TESTED_RANGE = `three 0.${TESTED_RELEASES.oldest} to 0.${TESTED_RELEASES.newest}`;

let isWarned = false;

/** Warns once on a page whose release of three no test has drawn with; it may draw all the same. */
export function warnOfUntestedThree(revision = REVISION): void {
  const release = Number.parseInt(revision, 10);
  const isTested = release >= TESTED_RELEASES.oldest && release <= TESTED_RELEASES.newest;
  if (isTested || isWarned) return;
  isWarned = true;
  console.warn(
    `This release of @websplatter/three is tested with ${TESTED_RANGE}, and this is r${revision}. If splats are wrong or missing, ` +
      'install one of these, or a newer @websplatter/three.',
  );
}
