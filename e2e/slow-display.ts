/**
 * For `addInitScript`: gives the page frames as a display of about 10 Hz does. A page that draws
 * all the time would otherwise keep SwiftShader, and with it the machine, busy while its test waits
 * or computes.
 */
export function slowDisplay(): void {
  const betweenFramesMs = 85;
  const request = window.requestAnimationFrame.bind(window);
  let lastId = 0;
  let waiting = new Map<number, FrameRequestCallback>();
  let running = new Map<number, FrameRequestCallback>();
  const runAll = (time: number) => {
    [running, waiting] = [waiting, new Map()];
    for (const callback of running.values()) {
      try {
        callback(time);
      } catch (error) {
        reportError(error);
      }
    }
  };
  window.requestAnimationFrame = (callback) => {
    if (waiting.size === 0) setTimeout(() => request(runAll), betweenFramesMs);
    lastId++;
    waiting.set(lastId, callback);
    return lastId;
  };
  window.cancelAnimationFrame = (id) => {
    waiting.delete(id);
    running.delete(id);
  };
}
