/**
 * Code lengths of a Huffman code with at most `most` bits per code, one per symbol. 0 for absent
 * symbols, 1 for a single symbol.
 */
export function codeLengths(counts: Uint32Array, most: number): Uint8Array {
  const lengths = new Uint8Array(counts.length);
  const symbols: number[] = [];
  for (let symbol = 0; symbol < counts.length; symbol++) if (counts[symbol] > 0) symbols.push(symbol);
  if (symbols.length === 1) lengths[symbols[0]] = 1;
  if (symbols.length <= 1) return lengths;
  // A larger least weight for rare symbols shortens the longest codes.
  for (let least = 1; ; least *= 2) {
    const weights = symbols.map((symbol) => Math.max(counts[symbol], least));
    const depths = depthsOf(weights);
    if (depths.every((depth) => depth <= most)) {
      symbols.forEach((symbol, i) => {
        lengths[symbol] = depths[i];
      });
      return lengths;
    }
  }
}

/** Depth of each leaf of a Huffman tree. */
function depthsOf(weights: readonly number[]): number[] {
  const count = weights.length;
  const order = weights.map((_, i) => i).sort((a, b) => weights[a] - weights[b] || a - b);
  const parents = new Int32Array(2 * count - 1);
  // Inner nodes are created in order of weight, so the two lightest nodes are heads of two queues.
  const sums = new Float64Array(count - 1);
  let leaf = 0;
  let inner = 0;
  for (let made = 0; made < count - 1; made++) {
    for (let child = 0; child < 2; child++) {
      const isLeaf = leaf < count && (inner >= made || weights[order[leaf]] <= sums[inner]);
      sums[made] += isLeaf ? weights[order[leaf]] : sums[inner];
      parents[isLeaf ? order[leaf++] : count + inner++] = count + made;
    }
  }
  const depths = new Array<number>(2 * count - 1).fill(0);
  for (let node = 2 * count - 3; node >= 0; node--) depths[node] = depths[parents[node]] + 1;
  // All inner nodes have their depth by now, so the order of the leaves does not matter.
  return depths.slice(0, count);
}

/** Canonical codes, bit-reversed: the first bit of a code is its lowest. */
export function codesOf(lengths: Uint8Array): Uint16Array {
  const codes = new Uint16Array(lengths.length);
  let next = 0;
  for (let length = 1; length <= 15; length++) {
    for (let symbol = 0; symbol < lengths.length; symbol++)
      if (lengths[symbol] === length) codes[symbol] = reversed(next++, length);
    next *= 2;
  }
  return codes;
}

function reversed(code: number, length: number): number {
  let result = 0;
  for (let i = 0; i < length; i++) result |= ((code >> i) & 1) << (length - 1 - i);
  return result;
}
