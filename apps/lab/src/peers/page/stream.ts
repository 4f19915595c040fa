import { pixelsOf, takenFrame } from './canvas-picture.ts';
import type { DrawnPeer } from './drawn-peer.ts';
import type { Watched } from './protocol.ts';
import type { WebGpuWatch } from './watch-webgpu.ts';

/** As on a usual display: loading gets the rest of the thread's time. */
const FRAME_MS = 1000 / 60;
/** A scene that has been complete for so long is at rest. */
const REST_MS = 1000;
/** The canvas is this much wider and higher than the pictures by which a first one is found. */
const SHRINK = 8;
/** Of a channel of such a picture; the rounding of a black background stays below. */
const LEAST_LEVEL = 8;
/** Pictures that may wait to be looked at: each is a copy of the canvas. */
const MOST_LOOKS = 4;

/** Draws frames until the scene is at rest; resolves with when it began to be, by the page's clock. */
export async function atRest(drawn: DrawnPeer, draw = () => drawn.frame()): Promise<number> {
  if (!drawn.peer.isComplete) throw new Error('The adapter does not say when its scene is complete.');
  for (let completeSinceMs: number | null = null; ; ) {
    const startedMs = performance.now();
    await draw();
    const endedMs = performance.now();
    completeSinceMs = drawn.peer.isComplete() ? (completeSinceMs ?? endedMs) : null;
    if (completeSinceMs !== null && endedMs - completeSinceMs >= REST_MS) return completeSinceMs;
    await new Promise((resolve) => setTimeout(resolve, FRAME_MS - (endedMs - startedMs)));
  }
}

/**
 * Draws a scene that streams until it is at rest, and finds the first frame that shows anything.
 *
 * @param startedMs by the page's clock.
 */
export async function watchFirst(
  drawn: DrawnPeer,
  webgpu: WebGpuWatch,
  startedMs: number,
): Promise<Omit<Watched, 'startedAtMs'>> {
  const small = async (png: Promise<Blob>) => (await pixelsOf(await png, SHRINK)).data;
  const found: { first?: { readonly pixels: Uint8ClampedArray; readonly endedMs: number } } = {};
  const look = async (png: Promise<Blob>, endedMs: number) => {
    const pixels = await small(png);
    const isFirst = endedMs < (found.first?.endedMs ?? Number.POSITIVE_INFINITY);
    if (isFirst && pixels.some((level, i) => i % 4 < 3 && level > LEAST_LEVEL))
      found.first = { pixels, endedMs };
  };
  // Every frame is looked at until one shows something; most need not wait for it.
  const looks: Promise<void>[] = [];
  await atRest(drawn, async () => {
    if (found.first) return drawn.frame();
    const { png } = await takenFrame(drawn, webgpu);
    looks.push(look(png, performance.now()));
    if (looks.length > MOST_LOOKS) await looks.shift();
  });
  await Promise.all(looks);
  const { first } = found;
  if (!first) throw new Error('The picture at rest is black.');
  const { png } = await takenFrame(drawn, webgpu);
  const firstPsnrDb = levelsPsnrDb(first.pixels, await small(png));
  return { firstPictureMs: first.endedMs - startedMs, firstPsnrDb };
}

/** Of two opaque pictures of a size, in RGBA of 8 bits each. */
function levelsPsnrDb(a: Uint8ClampedArray, b: Uint8ClampedArray): number {
  const squares = a.reduce((sum, level, i) => sum + (level - b[i]) ** 2, 0);
  return 10 * Math.log10((255 ** 2 * 0.75 * a.length) / squares);
}
