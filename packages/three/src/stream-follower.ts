import type { CloudStream } from '@websplatter/core';
import { SplatsStreamError } from './errors.ts';

/** What a follower tells of a scene that streams. */
interface StreamUser {
  /** The next frame is told by `drawn`. */
  readonly requestFrame: () => void;
  readonly onComplete: () => void;
  readonly onError: (error: SplatsStreamError) => void;
}

/** Tells when frames show all that there is room for, and when parts could not be fetched. */
export class StreamFollower {
  readonly #stream: CloudStream;
  readonly #user: StreamUser;
  readonly end: () => void;
  /** Whether the last frame was known to show all. */
  #wasComplete = false;
  #told: Error | null = null;

  constructor(stream: CloudStream, user: StreamUser) {
    this.#stream = stream;
    this.#user = user;
    this.end = stream.subscribe(() => this.#look());
  }

  /** A frame with what is there has been recorded. */
  drawn(): void {
    const { isComplete, error } = this.#stream.report();
    // It may have come before the first frame, while shaders compiled.
    this.#tell(error);
    if (isComplete && !this.#wasComplete) this.#user.onComplete();
    this.#wasComplete = isComplete;
  }

  #look(): void {
    const { isComplete, error } = this.#stream.report();
    // The frame to come shows what has arrived.
    if (isComplete && !this.#wasComplete) this.#user.requestFrame();
    if (!isComplete) this.#wasComplete = false;
    this.#tell(error);
  }

  #tell(error: Error | null): void {
    if (error && error !== this.#told)
      this.#user.onError(new SplatsStreamError(error, () => this.#stream.retry()));
    this.#told = error;
  }
}
