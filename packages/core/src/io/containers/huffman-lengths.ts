/**
 * Length of each symbol's code in a Huffman code without codes of more than `most` bits; 0 for
 * symbols that do not come, 1 for a lone one.
 */
export function codeLengths(counts: Uint32Array, most: number): Uint8Array {
  const lengths = new Uint8Array(counts.length);
  const symbols: number[] = [];
  for (let symbol = 0; symbol < counts.length; symbol++) if (counts[symbol] > 0) symbols.push(symbol);
  if (symbols.length === 1) lengths[symbols[0]] = 1;
  if (symbols.length <= 1) return lengths;
  // Codes that would be too long get shorter as the rarest symbols count for more.
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
  // Inner nodes come with growing weight, so two queues tell the two lightest nodes.
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
  // Leaves stand before all inner nodes, in any order: their parents' depths are known by now.
  return depths.slice(0, count);
}

/** Canonical codes as written, from the lowest bit on: a code's first bit is its lowest. */
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
