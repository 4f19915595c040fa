/**
 * Most time that a test waits for a state, ms: it ends what hangs, and says what was waited for, before the test's own limit does.
 * No test needs it, but a machine that does other things, too, takes twenty times as long as usual.
 */
export const PATIENCE_MS = 240_000;
