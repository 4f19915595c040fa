/**
 * Most time that a test waits for a state, ms: a test that hangs then fails, and says what it
 * awaited. No test needs it: states come within it on a busy machine that takes twenty times as
 * long as usual.
 */
export const PATIENCE_MS = 60_000;

/** The same for many frames: measurements, and any state in Firefox, which can take minutes. */
export const LONG_PATIENCE_MS = 240_000;
