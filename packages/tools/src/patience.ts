/**
 * Most time that a test waits for a state, ms: what hangs fails after it, and says what was awaited. No test needs it: on a machine
 * that does other things, too, and takes twenty times as long as usual, states come within it.
 */
export const PATIENCE_MS = 60_000;

/** The same for what takes many frames: measurements, and any state in Firefox, which has been seen to need more than a minute. */
export const LONG_PATIENCE_MS = 240_000;
