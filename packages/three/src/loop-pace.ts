import type { WebGPURenderer } from 'three/webgpu';

/** Calls of a loop whose work may wait for the GPU: as many as a display lets wait. */
const FEWEST_WAITING = 3;
/** As many as ever wait, on browsers that tell only now and then what the GPU has finished. */
const MOST_WAITING = 12;
/** Work that is finished within this time was waiting to be told of, not for the GPU. */
const TOLD_TOGETHER_MS = 4;

/**
 * Decides whether an animation loop may go on. A loop that nothing holds back, such as that of a
 * canvas that is not on the screen, would submit frames faster than a slow GPU draws them. Each
 * answer of the GPU, such as that of `pick`, would then wait for all of them. `setAnimationLoop` of
 * a renderer that draws splats is paced already.
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
  #toldMs = Number.NEGATIVE_INFINITY;
  #together = 0;

  /** Whether the GPU has so much to do that the next call of the loop is to be left out. */
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
    // That of a lost device rejects in some browsers.
    return queue.onSubmittedWorkDone().then(finished, finished);
  }

  #finished(nowMs: number): void {
    this.#waiting--;
    this.#together = nowMs - this.#toldMs <= TOLD_TOGETHER_MS ? this.#together + 1 : 1;
    this.#toldMs = nowMs;
    // A browser that tells of several at once needs twice as many under way, or the GPU would idle.
    this.#most = Math.min(MOST_WAITING, Math.max(this.#most, 2 * this.#together));
  }
}

/** Renderers whose loops are paced. */
const pacedRenderers = new WeakSet<WebGPURenderer>();

/**
 * Makes the animation loop of `renderer`, the present one and later ones, leave out calls while the
 * GPU is behind; but not in XR, where the headset sets the pace. Does so once for each renderer.
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
    // That of `getAnimationLoop`, set again.
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
  // That of an XR session is three's own.
  const present = renderer.xr.isPresenting ? null : renderer.getAnimationLoop();
  if (present) void renderer.setAnimationLoop(present);
}
