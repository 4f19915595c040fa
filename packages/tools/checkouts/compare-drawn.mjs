/**
 * What a checkout has drawn, by name: an image (`widthPx`, `heightPx`, `values`: Float32Array), a `value` that JSON can hold,
 * or why there is neither (`skipped`, `failed`).
 */

/**
 * Compares what two checkouts have drawn, output by output, in the first one's order.
 *
 * @param a, b maps from names to outputs.
 * @returns for each name whether all is well, in words what was found and, of images that differ, by how much.
 */
export function compareDrawn(a, b) {
  return [...new Set([...a.keys(), ...b.keys()])].map((name) => ({
    name,
    size: sizeOf(a.get(name) ?? b.get(name)),
    isSame: false,
    ...compareOutputs(a.get(name), b.get(name)),
  }));
}

function compareOutputs(a, b) {
  for (const [output, which] of [
    [a, 'A'],
    [b, 'B'],
  ]) {
    if (!output) return { finding: `missing in ${which}` };
    if ('failed' in output) return { finding: `failed in ${which}: ${output.failed}` };
  }
  if ('skipped' in a || 'skipped' in b) {
    if (!('skipped' in a && 'skipped' in b))
      return { finding: `skipped in ${'skipped' in a ? 'A' : 'B'} alone` };
    return { isSame: true, finding: `skipped: ${a.skipped}` };
  }
  if ('value' in a || 'value' in b) {
    const [textA, textB] = [a, b].map(({ value }) => JSON.stringify(value));
    return textA === textB
      ? { isSame: true, finding: 'identical' }
      : { finding: `differs: ${firstDifference(textA, textB)}` };
  }
  return compareImages(a, b);
}

/** Bit by bit: −0 is not 0, and a NaN is another NaN only where its bits are others. */
function compareImages(a, b) {
  if (a.widthPx !== b.widthPx || a.heightPx !== b.heightPx || a.values.length !== b.values.length)
    return { finding: `sizes differ: ${sizeOf(a)} and ${sizeOf(b)}` };
  // Two images without anything in them prove nothing.
  if (a.values.every((value) => value === a.values[0]) && b.values.every((value) => value === b.values[0]))
    return { finding: 'blank in A and B' };
  const [bitsA, bitsB] = [a, b].map(
    ({ values }) => new Uint32Array(values.buffer, values.byteOffset, values.length),
  );
  let differing = 0;
  let largest = 0;
  let squares = 0;
  for (let i = 0; i < bitsA.length; i++) {
    if (bitsA[i] === bitsB[i]) continue;
    differing++;
    const difference = Math.abs(a.values[i] - b.values[i]);
    // NaN, or infinite: as far apart as can be.
    largest = Math.max(largest, Number.isNaN(difference) ? Number.POSITIVE_INFINITY : difference);
    squares += difference * difference;
  }
  if (differing === 0) return { isSame: true, finding: 'identical' };
  const psnrDb = -10 * Math.log10(squares / bitsA.length);
  return { finding: `${differing} of ${bitsA.length} values differ`, largest, psnrDb };
}

function sizeOf(output) {
  return 'values' in output ? `${output.widthPx}×${output.heightPx}` : '';
}

/** Some characters about the first place where two texts differ. */
function firstDifference(a = 'nothing', b = 'nothing') {
  let at = 0;
  while (a[at] === b[at]) at++;
  const [partA, partB] = [a, b].map((text) => text.slice(Math.max(0, at - 30), at + 50));
  return `…${partA}… and …${partB}…`;
}
