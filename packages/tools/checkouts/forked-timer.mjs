import { fork } from 'node:child_process';
import { resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { findCheckout } from './checkout.mjs';

/** A process that times one checkout, and is idle unless it is asked. */
export class ForkedTimer {
  #child;

  /** @param module what the process runs: it gets `options` as JSON, says once what it runs on, then answers requests. */
  constructor(module, options) {
    this.#child = fork(module, [JSON.stringify(options)]);
  }

  /** Resolves with single times, ms. */
  async time(request) {
    this.#child.send(request);
    const { timesMs, error } = await this.answer();
    if (error) throw new Error(error);
    return timesMs;
  }

  /** The next thing that the process has to say. */
  answer() {
    return new Promise((fulfil, reject) => {
      const ended = (status, signal) =>
        reject(new Error(`drawing ended with ${signal ?? `status ${status}`}.`));
      this.#child.once('exit', ended);
      this.#child.once('message', (message) => {
        this.#child.off('exit', ended);
        fulfil(message);
      });
    });
  }

  end() {
    this.#child.kill();
  }
}

/** Indices of `timers` in the order of one round. Forwards and back: a machine that slows down in a run meets all alike. */
export function turns(timers, round) {
  const order = timers.map((_, i) => i);
  return round % 2 === 0 ? order : order.reverse();
}

export function medianOf(values) {
  return quantile(
    values.toSorted((a, b) => a - b),
    0.5,
  );
}

export function quantile(sorted, part) {
  return sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];
}

export function letterOf(index) {
  return String.fromCharCode('A'.charCodeAt(0) + index);
}

/** @throws Error naming the option. */
export function wholeNumber(option, text) {
  const number = Number(text);
  if (Number.isInteger(number) && number >= 1) return number;
  throw new Error(`--${option} has "${text}"; it takes whole numbers from 1 on.`);
}

/**
 * Reads the command line of a bench: the checkouts, what all benches take, and what `convert` makes of its own options. Ends the
 * process with `usage` where something is wrong.
 */
export function readBenchOptions(usage, ownOptions, convert) {
  try {
    const { values, positionals } = parseArgs({
      allowPositionals: true,
      options: { ...ownOptions, rounds: { type: 'string', default: '6' }, dawn: { type: 'string' } },
    });
    if (positionals.length === 0) throw new Error('No checkout is named.');
    return {
      checkouts: positionals.map(findCheckout),
      ...convert(values),
      rounds: wholeNumber('rounds', values.rounds),
      dawn: values.dawn ? resolve(values.dawn) : null,
    };
  } catch (error) {
    return stop(`${error.message}\n${usage}`);
  }
}

/** Ends the process because it was called wrongly. */
export function stop(message) {
  console.error(message);
  process.exit(2);
}
