// `npm run bench:sort -- A B`: GPU time of the radix sort alone, random keys. Checkouts take turns in one run, so that what
// else the machine does meets them alike: compare the ratios.
import os from 'node:os';
import { fileURLToPath } from 'node:url';
import { describeCheckout } from './checkouts/checkout.mjs';
import {
  ForkedTimer,
  letterOf,
  quantile,
  readBenchOptions,
  stop,
  turns,
  wholeNumber,
} from './checkouts/forked-timer.mjs';

const USAGE = `npm run bench:sort -- CHECKOUT [CHECKOUT…] [OPTION…]
  CHECKOUT        folder with built packages (npm run build); node_modules and .git are not needed with --dawn
  --keys N,N      numbers of keys; default 100000,600000,3450000,6000000
  --bits N,N      bits of keys; default 24,16
  --repeats N     sorts per round, of which the first two are not counted; default 12
  --rounds N      rounds, an even number; default 6
  --dawn FILE     the dawn.node of npm's webgpu, for folders without node_modules`;

const TIME_SORTS = fileURLToPath(new URL('checkouts/time-sorts.mjs', import.meta.url));
/** GPUs start slow after a pause. */
const UNCOUNTED = 2;

const { checkouts, keyCounts, keyBits, repeats, rounds, dawn } = readOptions();
const { model } = os.cpus()[0];
console.log(
  `${model}, ${os.cpus().length} cores, ${os.type()} ${os.release()}, Node ${process.versions.node}`,
);
const timers = [];
for (const [i, { path, folder }] of checkouts.entries()) {
  const timer = new ForkedTimer(TIME_SORTS, { folder, dawn });
  const { adapter, error } = await timer.answer().catch((error) => ({ error: error.message }));
  if (error) stop(`${path}: ${error}`);
  timers.push(timer);
  console.log(`${letterOf(i)}: ${path}, ${describeCheckout({ folder })}, on ${adapter}`);
}
console.log(`${rounds} rounds of ${repeats - UNCOUNTED} sorts each, in turns; GPU time, ms\n`);

const columns = timers.map((_, i) => `${letterOf(i)} median (P99)`.padStart(26)).join('');
console.log(`${'keys'.padStart(9)} ${'bits'.padStart(5)}${columns}`);
for (const bits of keyBits) {
  for (const keyCount of keyCounts) {
    const times = await measure(keyCount, bits).catch((error) => stop(error.message));
    const figures = times.map((own, i) => figuresOf(own, i === 0 ? null : times[0]).padStart(26)).join('');
    console.log(`${String(keyCount).padStart(9)} ${String(bits).padStart(5)}${figures}`);
  }
}
for (const timer of timers) timer.end();

/** Sorted times by checkout, ms. */
async function measure(keyCount, keyBits) {
  const times = timers.map(() => []);
  const request = { keyCount, keyBits, repeats };
  // Shaders are compiled in the first sort.
  for (const timer of timers) await timer.time({ ...request, seed: 1, isChecked: true });
  for (let round = 0; round < rounds; round++) {
    for (const i of turns(timers, round)) {
      const timesMs = await timers[i].time({ ...request, seed: round + 2, isChecked: false });
      times[i].push(...timesMs.slice(UNCOUNTED));
    }
  }
  return times.map((own) => own.sort((a, b) => a - b));
}

function figuresOf(sorted, first) {
  const median = quantile(sorted, 0.5);
  const ratio = first ? `×${(median / quantile(first, 0.5)).toFixed(3)} ` : '';
  return `${ratio}${median.toFixed(3)} (${quantile(sorted, 0.99).toFixed(3)})`;
}

function readOptions() {
  const own = {
    keys: { type: 'string', default: '100000,600000,3450000,6000000' },
    bits: { type: 'string', default: '24,16' },
    repeats: { type: 'string', default: '12' },
  };
  return readBenchOptions(USAGE, own, (values) => {
    const repeats = wholeNumber('repeats', values.repeats);
    if (repeats <= UNCOUNTED)
      throw new Error(`--repeats has ${repeats}; the first ${UNCOUNTED} are not counted.`);
    return {
      keyCounts: values.keys.split(',').map((text) => wholeNumber('keys', text)),
      keyBits: values.bits.split(',').map((text) => wholeNumber('bits', text)),
      repeats,
    };
  });
}
