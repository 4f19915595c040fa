import { WebSplatterError } from '@websplatter/core';

/** The renderer cannot draw splats: it is not three's WebGPURenderer on a device of this library. */
export class SplatsUnsupportedRendererError extends WebSplatterError {
  override readonly name = 'SplatsUnsupportedRendererError';
  constructor(message: string) {
    super('unsupported-renderer', message);
  }
}

/**
 * Splats are drawn less exactly than was asked for, or take more memory: `cause` says why. The picture stays as it was.
 */
export class SplatsPrecisionError extends WebSplatterError {
  override readonly name = 'SplatsPrecisionError';
  constructor(cause: Error) {
    super('precision-unavailable', `Splats keep the precision that they have. ${cause.message}`, { cause });
  }
}

/** Splats cannot be drawn into this pass of three's, since it cannot be interrupted. */
export class SplatsPassError extends WebSplatterError {
  override readonly name = 'SplatsPassError';
  constructor(message: string) {
    super('unsupported-pass', message);
  }
}

/** This release of three keeps its renderer's state elsewhere than the releases that are supported. */
export class ThreeInternalsError extends WebSplatterError {
  override readonly name = 'ThreeInternalsError';
  /** Path of what was looked for, e.g. `renderer.backend.get`. */
  readonly missing: string;
  /** three's `REVISION`. */
  readonly revision: string;

  constructor(missing: string, revision: string) {
    super(
      'three-internals',
      `three r${revision} has no ${missing}, which drawing splats between its passes needs. ` +
        'Supported are three 0.185 to 0.187; install one of them, or a newer release of @websplatter/three.',
    );
    this.missing = missing;
    this.revision = revision;
  }
}
