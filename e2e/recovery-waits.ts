/** For `addInitScript`: the waits of a recovery pass at once. */
export function skipRecoveryWaits(): void {
  const { setTimeout } = window;
  const isWait = (ms: number) => [1000, 4000, 16_000].includes(ms);
  window.setTimeout = ((run: () => void, ms = 0, ...values: []) =>
    setTimeout(run, isWait(ms) ? 0 : ms, ...values)) as typeof window.setTimeout;
}
