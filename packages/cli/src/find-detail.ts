import { type DetailReport, type FrameRequest, isFixedDetail, type SplatView } from '@websplatter/core';

/** Finds the detail of a picture that asks for an outcome; ends the view. */
export async function findDetail(
  view: SplatView,
  frame: FrameRequest,
): Promise<Pick<DetailReport, 'drawn' | 'measuredPsnrDb'>> {
  const { detail = 'full' } = frame;
  try {
    if (isFixedDetail(detail)) return { drawn: detail, measuredPsnrDb: null };
    view.render(frame);
    await view.whenComplete();
    return view.detail!;
  } finally {
    view.destroy();
  }
}
