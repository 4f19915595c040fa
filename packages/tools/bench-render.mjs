// `npm run bench:render -- A B`: CPU time of view.render and EmbeddedView.prepare, the calls themselves, with a moving camera.
// Checkouts take turns in one run, so that what else the machine does meets them alike: compare the ratios. On a
// machine that others use too, P10 is the least disturbed figure.
import os from 'node:os';
import { fileURLToPath } from 'node:url';
import { describeCheckout } from './checkouts/checkout.mjs';
import {
  ForkedTimer,
  letterOf,
  medianOf,
  quantile,
  readBenchOptions,
  stop,
  turns,
  wholeNumber,
} from './checkouts/forked-timer.mjs';

const USAGE = `npm run bench:render -- CHECKOUT [CHECKOUT…] [OPTION…]
  CHECKOUT        folder with built packages (npm run build); node_modules and .git are not needed with --dawn
  --clouds N,N    how many clouds are drawn; default 1,50
  --frames N      frames per round; default 30
  --rounds N      rounds, an even number; default 6
  --dawn FILE     the dawn.node of npm's webgpu, for folders without node_modules`;

const TIME_FRAMES = fileURLToPath(new URL('checkouts/time-frames.mjs', import.meta.url));
const BENCHES = ['view.render', 'EmbeddedView.prepare'];

const { checkouts, cloudCounts, frames, rounds, dawn } = readOptions();
const { model } = os.cpus()[0];
console.log(
  `${model}, ${os.cpus().length} cores, ${os.type()} ${os.release()}, Node ${process.versions.node}`,
);

const timers = [];
for (const [i, { path, folder }] of checkouts.entries()) {
  const timer = new ForkedTimer(TIME_FRAMES, { folder, dawn });
  const { adapter } = await timer.answer().catch((error) => stop(`${path}: ${error.message}`));
  timers.push(timer);
  console.log(`${letterOf(i)}: ${path}, ${describeCheckout({ folder })}, on ${adapter}`);
}
console.log(
  `${rounds} rounds of ${frames} frames each, in turns (${turns(timers, 0).map(letterOf).join(' ')}, then back)`,
);

for (const bench of BENCHES) {
  for (const cloudCount of cloudCounts) {
    const times = await measure(bench, cloudCount).catch((error) => stop(error.message));
    console.log(`\n${bench}, ${cloudCount} ${cloudCount === 1 ? 'cloud' : 'clouds'}`);
    for (const [i, timesMs] of times.entries()) console.log(lineOf(i, timesMs, times[0]));
  }
}
for (const timer of timers) timer.end();

/** Times by checkout and round, ms. */
async function measure(bench, cloudCount) {
  const times = timers.map(() => []);
  for (const timer of timers) await timer.time({ bench, cloudCount, frames: 2 * frames, isWarmUp: true });
  for (let round = 0; round < rounds; round++)
    for (const i of turns(timers, round)) times[i].push(await timers[i].time({ bench, cloudCount, frames }));
  return times;
}

function lineOf(index, times, firstTimes) {
  const [first, own] = [firstTimes, times].map((rounds) => rounds.flat().sort((a, b) => a - b));
  const [p10, median, p99] = [0.1, 0.5, 0.99].map((part) => {
    const figure = (1000 * quantile(own, part)).toFixed(1).padStart(8);
    return index === 0
      ? `${figure} µs`
      : `${figure} µs (×${(quantile(own, part) / quantile(first, part)).toFixed(3)})`;
  });
  const figures = `${letterOf(index)}  P10 ${p10}  median ${median}  P99 ${p99}`;
  if (index === 0) return figures;
  const ratios = times.map((round, i) => medianOf(round) / medianOf(firstTimes[i])).sort((a, b) => a - b);
  return `${figures}  medians of single rounds ×${ratios[0].toFixed(3)}…${ratios.at(-1).toFixed(3)}`;
}

function readOptions() {
  const own = { clouds: { type: 'string', default: '1,50' }, frames: { type: 'string', default: '30' } };
  return readBenchOptions(USAGE, own, (values) => ({
    cloudCounts: values.clouds.split(',').map((text) => wholeNumber('clouds', text)),
    frames: wholeNumber('frames', values.frames),
  }));
}
