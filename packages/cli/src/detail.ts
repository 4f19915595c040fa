import {
  type Detail,
  type DetailReport,
  type FrameRequest,
  isFixedDetail,
  type SplatView,
} from '@websplatter/core';

/**
 * Finds the detail of a picture that asks for an outcome, and waits until the visible parts of streamed
 * scenes are on the GPU; ends the view.
 *
 * @throws the error for which a streamed scene could not be read.
 */
export async function findDetail(
  view: SplatView,
  frame: FrameRequest,
): Promise<Pick<DetailReport, 'drawn' | 'measuredPsnrDb'>> {
  const { detail = 'full' } = frame;
  try {
    const streams = frame.clouds.flatMap(({ cloud }) => cloud.stream ?? []);
    if (isFixedDetail(detail) && streams.length === 0) return { drawn: detail, measuredPsnrDb: null };
    view.render(frame);
    await view.whenComplete();
    for (const stream of streams) {
      const { error } = stream.report();
      if (error) throw error;
    }
    return view.detail!;
  } finally {
    view.destroy();
  }
}

/**
 * The line about frames of less than full detail; null for others.
 *
 * @param psnrDb as it was measured for the frame; null if it was not.
 */
export function detailText(
  detail: Detail,
  drawnSplats: number,
  loadedSplats: number,
  psnrDb: number | null = null,
): string | null {
  if (detail === 'full') return null;
  const written = (count: number) => count.toLocaleString('en');
  const limits: Readonly<Record<string, (value: number) => string>> = {
    maxErrorPx: (px) => `about ${px} px of error at most`,
    maxSplats: (count) => `at most ${written(count)} splats`,
    maxShare: (share) => `at most ${Number((100 * share).toPrecision(3))} % of the splats in sight`,
    minPsnrDb: (decibels) => `at least ${decibels} dB`,
    maxFrameMs: (ms) => `moving frames within ${ms} ms`,
  };
  const asked =
    detail === 'auto'
      ? 'smooth motion'
      : Object.entries(detail)
          .map(([name, value]) => limits[name](value))
          .join(', ');
  const measured =
    psnrDb === null
      ? ''
      : `, ${psnrDb === Infinity ? 'equal to full detail' : `${psnrDb.toFixed(1)} dB measured`}`;
  return `${asked}: ${written(drawnSplats)} splats and merged splats drawn for ${written(loadedSplats)} splats${measured}`;
}
