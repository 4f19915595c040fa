import { nextTask } from '../adapter.ts';
import { turnedCamera } from '../turned-camera.ts';
import type { DrawnPeer } from './drawn-peer.ts';
import type { GpuTime } from './gpu-time.ts';
import type { Measured, MeasureRequest } from './protocol.ts';

const TURN = 2 * Math.PI;
/** The golden angle: successive jumps are far apart, and no place comes twice. */
const JUMP = TURN * (1 - 1 / ((1 + Math.sqrt(5)) / 2));

export async function measure(
  drawn: DrawnPeer,
  gpuTime: GpuTime | null,
  request: MeasureRequest,
): Promise<Measured> {
  const { camera, frames, warmUpFrames, jumps } = request;
  const { peer } = drawn;
  const step = TURN / frames;
  for (let frame = -warmUpFrames; frame < 0; frame++) {
    peer.setCamera(turnedCamera(camera, frame * step));
    await drawn.frame();
    await nextTask();
  }

  await drawn.correctFrame(camera);
  const ordersBefore = peer.orders?.();
  const turnMs: number[] = [];
  // From the first step on: a peer may leave out a frame in which nothing has changed.
  for (let frame = 1; frame <= frames; frame++) {
    const startedMs = performance.now();
    peer.setCamera(turnedCamera(camera, frame * step));
    await drawn.frame();
    turnMs.push(performance.now() - startedMs);
    // Orders of workers and the compositor get their turn.
    await nextTask();
  }
  const orders = ordersBefore === undefined ? null : peer.orders!() - ordersBefore;

  await drawn.correctFrame(camera);
  const correctMs: number[] = [];
  for (let jump = 1; jump <= jumps; jump++) {
    // A worker that still sorts for the view before would be charged to this one.
    await peer.order?.();
    await nextTask();
    const startedMs = performance.now();
    await drawn.correctFrame(turnedCamera(camera, jump * JUMP));
    correctMs.push(performance.now() - startedMs);
  }

  const gpuMs: number[] = [];
  for (let frame = 1; gpuTime && frame <= frames; frame++) {
    peer.setCamera(turnedCamera(camera, frame * step));
    gpuMs.push(await gpuTime.timeMs(() => drawn.frame()));
    await nextTask();
  }
  return { turnMs, orders, correctMs, gpuMs };
}
