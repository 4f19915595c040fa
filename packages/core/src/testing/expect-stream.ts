// Holds streams of both kinds against what they promise. They have not been seen yet, and cannot read.
import { expect } from 'vitest';
import type { StreamReport } from '../clouds/cloud-stream.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { SplatEngine } from '../create-engine.ts';
import type { FrameRequest } from '../frame/frame-request.ts';

type Look = Omit<FrameRequest, 'clouds'> & { readonly cloud: SplatCloud };

/**
 * Expects reports of what is fetched, and when views have all that they need; destroys the cloud.
 *
 * @param give lets the stream read.
 * @param fetching what is reported before.
 * @param splats a budget, whose needs are known once a frame has been measured.
 */
export async function expectReports(
  engine: SplatEngine,
  { cloud, ...look }: Look,
  {
    give,
    fetching,
    splats,
  }: { readonly give: () => void; readonly fetching: Partial<StreamReport>; readonly splats: number },
): Promise<void> {
  const stream = cloud.stream!;
  expect(stream.report()).toMatchObject({ isComplete: false, missingBricks: 0, bytesPerSecond: 0 });
  const seen: StreamReport[] = [];
  const stop = stream.subscribe(() => seen.push(stream.report()));
  const view = engine.createView();
  const request = { ...look, clouds: [{ cloud }] };
  view.render(request);
  // What is lacking is fetched once the frame is submitted.
  await expect.poll(() => seen.at(-1)).toMatchObject({ isComplete: false, ...fetching });
  give();
  await view.whenComplete();
  const atRest = { isComplete: true, missingBricks: 0, bytesPerSecond: 0 };
  await expect.poll(() => seen.at(-1)).toMatchObject(atRest);
  expect(seen.some(({ bytesPerSecond }) => bytesPerSecond > 0)).toBe(true);
  const before = seen.length;
  stop();
  view.render({ ...request, detail: { maxSplats: splats } });
  expect(stream.report()).toMatchObject({ isComplete: false, missingBricks: 0 });
  await view.whenComplete();
  expect(stream.report().isComplete).toBe(true);
  expect(seen).toHaveLength(before);
  stream.subscribe(() => seen.push(stream.report()));
  cloud.destroy();
  await expect.poll(() => seen.length).toBeGreaterThan(before);
  expect(seen.at(-1)).toMatchObject({ isComplete: false });
  view.destroy();
}

/**
 * Expects fetches to end with their last view, and with their cloud.
 *
 * @param signals those of the fetches that have begun.
 */
export async function expectEnds(
  engine: SplatEngine,
  { cloud, ...look }: Look,
  signals: readonly AbortSignal[],
): Promise<void> {
  const request = { ...look, clouds: [{ cloud }] };
  const view = engine.createView();
  view.render(request);
  await null;
  expect(signals.length).toBeGreaterThan(0);
  view.destroy();
  expect(signals.every(({ aborted }) => aborted)).toBe(true);
  const other = engine.createView();
  other.render(request);
  await null;
  cloud.destroy();
  expect(signals.every(({ aborted }) => aborted)).toBe(true);
  other.destroy();
}
