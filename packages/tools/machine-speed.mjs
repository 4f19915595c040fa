// Prints how long fixed work on all cores takes here, and that time divided by what the two idle cores of
// docs/tests.md took: durations of test runs mean little without it. Takes some four seconds.
import { availableParallelism, loadavg } from 'node:os';
import { isMainThread, parentPort, Worker } from 'node:worker_threads';
import { deflateSync } from 'node:zlib';

/** Time of the fixed work on the two idle cores of docs/tests.md, ms. */
const REFERENCE_MS = 4000;
/** Twice as many pieces as cores, so that a core that is busy with other work counts. */
const PIECES_PER_CORE = 2;

/** Numbers, memory and bytes, as a software rasteriser and a compiler use them. */
function work() {
  const values = new Float64Array(2 ** 21);
  for (let round = 0; round < 80; round++)
    for (let i = 0; i < values.length; i++)
      values[i] = Math.sqrt(values[(i * 257) & (2 ** 21 - 1)] + i) * 0.5;
  deflateSync(new Uint8Array(values.buffer), { level: 6 });
}

if (isMainThread) {
  const cores = availableParallelism();
  const startMs = performance.now();
  let left = cores * PIECES_PER_CORE;
  await Promise.all(
    Array.from({ length: cores }, async () => {
      const worker = new Worker(new URL(import.meta.url));
      while (left-- > 0) {
        worker.postMessage(null);
        await new Promise((resolve, reject) => worker.once('message', resolve).once('error', reject));
      }
      await worker.terminate();
    }),
  );
  const elapsedMs = performance.now() - startMs;
  console.log(
    `Machine: ${cores} cores, load ${loadavg()[0].toFixed(1)}; fixed work took ${(elapsedMs / 1000).toFixed(1)} s, ` +
      `${(elapsedMs / REFERENCE_MS).toFixed(2)} times the reference.`,
  );
} else {
  parentPort.on('message', () => {
    work();
    parentPort.postMessage(null);
  });
}
