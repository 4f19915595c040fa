import { timeSpread } from '@websplatter/core/measure';
import { syntheticCamera } from '@websplatter/scenes';
import { WAITS, type Wait } from '../page/completion.ts';
import type { MeasureRequest } from '../page/protocol.ts';
import type { SizePx } from './bench-definition.ts';
import { BLANK_PAGE } from './built-pages.ts';
import type { Visitor } from './visit.ts';

interface Asked extends Pick<MeasureRequest, 'frames' | 'warmUpFrames' | 'jumps'> {
  readonly size: SizePx;
}

/** Finds the quickest wait when nothing is drawn, not even loaded: all peers get it. */
export async function quickestWait(
  visitor: Visitor,
  floorUrl: string,
  { size, frames, warmUpFrames, jumps }: Asked,
  say: (line: string) => void,
): Promise<{ readonly wait: Wait; readonly adapter: string | null }> {
  const camera = syntheticCamera;
  const floors = await visitor.visit(floorUrl, size, async (page) => {
    const found = [];
    for (const wait of WAITS) {
      const url = new URL(`/${BLANK_PAGE}`, floorUrl).href;
      await page.load({ ...size, url, fileName: BLANK_PAGE, wait, camera });
      const { correctMs } = await page.measure({ camera, frames, warmUpFrames, jumps });
      const { adapter } = await page.state();
      found.push({ wait, ms: timeSpread(correctMs).median, adapter });
    }
    return found;
  });
  const quickest = floors.reduce((best, each) => (each.ms < best.ms ? each : best));
  say(`Waiting for WebGPU: ${floors.map(({ wait, ms }) => `${wait} ${ms.toFixed(2)} ms`).join(', ')}.`);
  return quickest;
}
