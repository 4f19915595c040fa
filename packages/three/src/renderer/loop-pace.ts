import type { WebGPURenderer } from 'three/webgpu';

/** Frames that may be submitted and unfinished, at first: as many as a display queues. */
const FEWEST_WAITING = 3;
/** Most unfinished frames, on browsers that report finished work in batches. */
const MOST_WAITING = 12;
/** Work reported as finished within this time belongs to one batch, ms. */
const BATCH_MS = 4;

/**
 * Decides whether an animation loop may submit another frame. The loop of a canvas that is not on
 * the screen has no display to limit it, and would submit frames faster than a slow GPU draws them.
 * Each read-back, such as `pick`, would wait for all submitted frames. `setAnimationLoop` of a
 * renderer that draws splats is paced already.
 *
 * @example
 * const pace = new LoopPace();
 * const { queue } = splatEngineOf(renderer).device;
 * requestAnimationFrame(function loop() {
 *   requestAnimationFrame(loop);
 *   if (pace.isBehind) return;
 *   renderer.render(scene, camera);
 *   pace.submitted(queue);
 * });
 */
export class LoopPace {
  #waiting = 0;
  #most = FEWEST_WAITING;
  #finishedMs = Number.NEGATIVE_INFINITY;
  #batchSize = 0;

  /** Whether the GPU is so far behind that the loop should skip its next frame. */
  get isBehind(): boolean {
    return this.#waiting >= this.#most;
  }

  /**
   * Counts a call of the loop, which has submitted its work to `queue`.
   *
   * @returns a promise that resolves when the GPU has finished that work, or is lost.
   */
  submitted(queue: Pick<GPUQueue, 'onSubmittedWorkDone'>): Promise<void> {
    this.#waiting++;
    const finished = () => this.#finished(performance.now());
    // Some browsers reject when the device is lost.
    return queue.onSubmittedWorkDone().then(finished, finished);
  }

  #finished(nowMs: number): void {
    this.#waiting--;
    this.#batchSize = nowMs - this.#finishedMs <= BATCH_MS ? this.#batchSize + 1 : 1;
    this.#finishedMs = nowMs;
    // With fewer than two batches under way, the GPU would idle until the next report.
    this.#most = Math.min(MOST_WAITING, Math.max(this.#most, 2 * this.#batchSize));
  }
}

const pacedRenderers = new WeakSet<WebGPURenderer>();

/**
 * Makes the animation loop of `renderer`, the present one and later ones, skip calls while the GPU
 * is behind; but not in XR, where the headset sets the pace. Does so once for each renderer.
 */
export function paceAnimationLoop(
  renderer: WebGPURenderer,
  queue: Pick<GPUQueue, 'onSubmittedWorkDone'>,
): void {
  if (pacedRenderers.has(renderer)) return;
  pacedRenderers.add(renderer);
  const pace = new LoopPace();
  type Loop = NonNullable<Parameters<WebGPURenderer['setAnimationLoop']>[0]>;
  const pacedLoops = new WeakSet<Loop>();
  const paced = (loop: Loop): Loop => {
    // A paced loop that `getAnimationLoop` returned and that is set again.
    if (pacedLoops.has(loop)) return loop;
    const made: Loop = (...frame) => {
      if (renderer.xr.isPresenting) return loop(...frame);
      if (pace.isBehind) return;
      loop(...frame);
      void pace.submitted(queue);
    };
    pacedLoops.add(made);
    return made;
  };
  const setAnimationLoop = renderer.setAnimationLoop.bind(renderer);
  renderer.setAnimationLoop = (loop) => setAnimationLoop(loop && paced(loop));
  // In an XR session, `getAnimationLoop` returns three's own loop.
  const present = renderer.xr.isPresenting ? null : renderer.getAnimationLoop();
  if (present) void renderer.setAnimationLoop(present);
}
