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
 * Compares the times of two checkouts: a line for each stage, each pass and whole frames.
 *
 * @param a, b `FrameMeasurement`s, one per round; both of a round were measured next to each other.
 */
export function timeRatios(a, b) {
  const [first, second] = [a, b].map((rounds) => rounds.map(spreadsOf));
  const names = Object.keys(first[0]).filter((name) => second[0][name]);
  const width = Math.max(...names.map((name) => name.length));
  return names.map((name) => {
    const cells = ['median', 'p99'].map((figure) => {
      const [timesA, timesB] = [first, second].map((rounds) =>
        rounds.map((spreads) => spreads[name][figure]),
      );
      const ratios = timesA.map((time, round) => timesB[round] / time).sort((x, y) => x - y);
      const times = `${middleOf(timesA).toFixed(3)} → ${middleOf(timesB).toFixed(3)}`;
      const [middle, least, most] = [middleOf(ratios), ratios[0], ratios.at(-1)].map((ratio) =>
        ratio.toFixed(3),
      );
      return `${figure} ${times} ×${middle} (${least}–${most})`;
    });
    return `${name.padEnd(width)}  ${cells.join('  ')}`;
  });
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
