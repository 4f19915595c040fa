/**
 * Most time that a test waits for a state, ms, so that a hanging test fails and names the state. No
 * passing test needs it: it allows for a machine that takes forty times as long as usual.
 */
export const PATIENCE_MS = 120_000;

/**
 * The same for many frames, as in measurements, and for Firefox, where any state may take minutes.
 */
export const LONG_PATIENCE_MS = 240_000;

/** Why a test is skipped for which a run with an end has no time (`deadline.ts`). */
export const NO_TIME = 'no time was left';
