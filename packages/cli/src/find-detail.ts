import { type DetailReport, type FrameRequest, isFixedDetail, type SplatView } from '@websplatter/core';

/**
 * Finds the detail of a picture that asks for an outcome, and has what it shows of scenes that stream
 * on the GPU; ends the view.
 *
 * @throws what such a scene could not be read for.
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
