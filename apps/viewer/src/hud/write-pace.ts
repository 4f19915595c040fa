/** Figures that change faster than this cannot be read. */
export const LEAST_PAUSE_MS = 120;
/** Slower figures would seem to stand still. */
const MOST_PAUSE_MS = 1000;
/** CPU time that figures may take of each frame. */
export const FIGURES_BUDGET_MS = 0.2;

/**
 * Time from one write of figures to the next: so long that, shared out among the frames between, a
 * write takes no more than the budget.
 *
 * @param writeMs CPU time of a write.
 * @param frameMs time from one frame to the next.
 */
export function pauseBetweenWrites(writeMs: number, frameMs: number): number {
  const pauseMs = (writeMs / FIGURES_BUDGET_MS) * frameMs;
  return Math.min(MOST_PAUSE_MS, Math.max(LEAST_PAUSE_MS, pauseMs));
}
