/** Fewer splats than this are made sooner than another worker starts. */
const LEAST_SPLATS = 15_000;

/** In how many shares a scene is made, one in each worker. One processor is left for the page. */
export function numberOfShares(splats: number, processors: number): number {
  return Math.max(1, Math.min(Math.floor(splats / LEAST_SPLATS), processors - 1));
}
