import type { CloudStream } from '@websplatter/core';
import { SplatsStreamError } from '../errors.ts';

/** Callbacks for changes of a streamed scene. */
interface StreamUser {
  /** Requests a frame; call `drawn` when it is recorded. */
  readonly requestFrame: () => void;
  readonly onComplete: () => void;
  readonly onError: (error: SplatsStreamError) => void;
}

/** Reports when frames of a streamed scene are complete, and when parts could not be fetched. */
export class StreamFollower {
  readonly #stream: CloudStream;
  readonly #user: StreamUser;
  readonly end: () => void;
  /** Whether the last frame was complete. */
  #wasComplete = false;
  #reported: Error | null = null;

  constructor(stream: CloudStream, user: StreamUser) {
    this.#stream = stream;
    this.#user = user;
    this.end = stream.subscribe(() => this.#update());
  }

  /** Call after recording a frame of the scene. */
  drawn(): void {
    const { isComplete, error } = this.#stream.report();
    // The error may be older than the first frame, whose shaders had to be compiled.
    this.#reportError(error);
    if (isComplete && !this.#wasComplete) this.#user.onComplete();
    this.#wasComplete = isComplete;
  }

  #update(): void {
    const { isComplete, error } = this.#stream.report();
    // Completeness is reported once a frame with all parts is recorded.
    if (isComplete && !this.#wasComplete) this.#user.requestFrame();
    if (!isComplete) this.#wasComplete = false;
    this.#reportError(error);
  }

  #reportError(error: Error | null): void {
    if (error && error !== this.#reported)
      this.#user.onError(new SplatsStreamError(error, () => this.#stream.retry()));
    this.#reported = error;
  }
}
