/**
 * Compares two images bit by bit: −0 differs from 0, and NaNs are equal if their bits are.
 *
 * @param a, b Float32Array, or null if the image is missing.
 * @returns whether the images are equal and not empty, with a description.
 */
export function compareImages(a, b) {
  const differs = (finding) => ({ isSame: false, finding });
  if (!a || !b) return differs(`missing in ${a ? 'B' : 'A'}`);
  if (a.length !== b.length) return differs(`${a.length} and ${b.length} values`);
  // Two empty images prove nothing.
  if ([a, b].every((values) => values.every((value) => value === values[0])))
    return differs('blank in A and B');
  const [bitsA, bitsB] = [a, b].map(({ buffer }) => new Uint32Array(buffer));
  let differing = 0;
  let largest = 0;
  let squares = 0;
  for (let i = 0; i < bitsA.length; i++) {
    if (bitsA[i] === bitsB[i]) continue;
    differing++;
    const difference = Math.abs(a[i] - b[i]);
    // Differences to NaN or infinity count as infinite.
    largest = Math.max(largest, Number.isNaN(difference) ? Number.POSITIVE_INFINITY : difference);
    squares += difference * difference;
  }
  if (differing === 0) return { isSame: true, finding: 'identical' };
  const psnrDb = -10 * Math.log10(squares / bitsA.length);
  const amount = `by at most ${largest.toPrecision(3)}, PSNR ${psnrDb.toFixed(1)} dB`;
  return differs(`${differing} of ${bitsA.length} values differ, ${amount}`);
}

/**
 * Compares the times of two checkouts: for each stage, each pass and whole frames, the median and the
 * P99, each with `a` and `b` in ms, and `ratio`, `least` and `most` of B beside A over the rounds.
 *
 * @param a, b `FrameMeasurement`s, one per round; both of a round were measured next to each other.
 */
export function timeRatios(a, b) {
  const [first, second] = [a, b].map((rounds) => rounds.map(spreadsOf));
  const compared = (name, figure) => {
    const [timesA, timesB] = [first, second].map((rounds) => rounds.map((spreads) => spreads[name][figure]));
    const ratios = timesA.map((time, round) => timesB[round] / time).sort((x, y) => x - y);
    const [ratio, least, most] = [middleOf(ratios), ratios[0], ratios.at(-1)];
    return { a: middleOf(timesA), b: middleOf(timesB), ratio, least, most };
  };
  return Object.keys(first[0])
    .filter((name) => second[0][name])
    .map((name) => ({ name, median: compared(name, 'median'), p99: compared(name, 'p99') }));
}

/** Formats what `timeRatios` found, a line for each. */
export function ratioLines(found) {
  const width = Math.max(...found.map(({ name }) => name.length));
  const cell = (figure, { a, b, ratio, least, most }) => {
    const [middle, low, high] = [ratio, least, most].map((each) => each.toFixed(3));
    return `${figure} ${a.toFixed(3)} → ${b.toFixed(3)} ×${middle} (${low}–${high})`;
  };
  return found.map(
    ({ name, median, p99 }) => `${name.padEnd(width)}  ${cell('median', median)}  ${cell('p99', p99)}`,
  );
}

/** What `timeRatios` found as a table of evidence. */
export function ratioTable(found, caption) {
  const headings = ['A, ms', 'B, ms', 'B / A', 'least', 'most'];
  const cells = ({ a, b, ratio, least, most }) => [a, b, ratio, least, most];
  return {
    caption,
    columns: ['part', ...['median', 'P99'].flatMap((figure) => headings.map((each) => `${figure}, ${each}`))],
    rows: found.map(({ name, median, p99 }) => [name, ...cells(median), ...cells(p99)]),
  };
}

/** Distributions of times by name; for a pass that occurs twice, the last one. */
function spreadsOf({ stageMs, gpuMs, wallClockMs, passes }) {
  const named = (passes ?? []).map(({ part, stage, timeMs }) => [`${part}: ${stage}`, timeMs]);
  return {
    ...stageMs,
    ...(gpuMs && { 'frame, GPU': gpuMs }),
    'frame, wall clock': wallClockMs,
    ...Object.fromEntries(named),
  };
}

function middleOf(values) {
  const sorted = values.toSorted((x, y) => x - y);
  const middle = (sorted.length - 1) / 2;
  return (sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2;
}
