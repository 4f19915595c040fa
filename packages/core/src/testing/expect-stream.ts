// Expectations of streamed scenes, in bricks or in leaves. Pass a cloud that no view has drawn yet, and
// whose reads are blocked.
import { expect } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { StreamReport } from '../clouds/stream/cloud-stream.ts';
import type { SplatEngine } from '../create-engine.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';

type Look = Omit<FrameRequest, 'clouds'> & { readonly cloud: SplatCloud };

/**
 * Expects reports while parts are fetched, and once views have all that they need; destroys the
 * cloud.
 *
 * @param give lets blocked reads resolve.
 * @param release lets the steps after the reads proceed; only if the caller blocked those, too.
 * @param fetching expected fields of the report while reads are blocked.
 * @param splats budget of a further frame, which needs other parts.
 */
export async function expectReports(
  engine: SplatEngine,
  { cloud, ...look }: Look,
  {
    give,
    release,
    fetching,
    splats,
  }: {
    readonly give: () => void;
    readonly release?: () => void;
    readonly fetching: Partial<StreamReport>;
    readonly splats: number;
  },
): Promise<void> {
  const stream = cloud.stream!;
  expect(stream.report()).toMatchObject({ isComplete: false, missingBricks: 0, bytesPerSecond: 0 });
  const seen: StreamReport[] = [];
  const stop = stream.subscribe(() => seen.push(stream.report()));
  const view = engine.createView();
  const request = { ...look, clouds: [{ cloud }] };
  view.render(request);
  // Missing parts are fetched once the frame is submitted.
  await expect.poll(() => seen.at(-1)).toMatchObject({ isComplete: false, ...fetching });
  give();
  const haveBytes = () => seen.some(({ bytesPerSecond }) => bytesPerSecond > 0);
  if (release) await expect.poll(haveBytes).toBe(true);
  release?.();
  await view.whenComplete();
  const atRest = { isComplete: true, missingBricks: 0, bytesPerSecond: 0 };
  await expect.poll(() => seen.at(-1)).toMatchObject(atRest);
  expect(haveBytes()).toBe(true);
  const before = seen.length;
  stop();
  view.render({ ...request, detail: { maxSplats: splats } });
  expect(stream.report().isComplete).toBe(false);
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
 * Expects fetches to be cancelled when their last view, or their cloud, is destroyed.
 *
 * @param signals the signal of each fetch that has begun; grows.
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
