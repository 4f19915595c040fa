// Where the splats and blobs of a cell lie, where its roots become leaves of the cell above, and how
// its bits are counted.
import constants::CELL_CHILDREN;
import constants::CELL_ROOTS;
import layout::MergeParameters;

/// Chunk of a cell's splats and chunk of its blobs. Above the first level, one buffer holds both kinds
/// for all levels.
fn chunksOf(parameters: MergeParameters, cell: u32) -> vec2u {
  @if(!UPPER) return vec2u(cell - parameters.pageStart);
  @if(UPPER) return 2u * (cell - parameters.upperStart) + vec2u(0u, 1u);
}

/// Chunk, counted from the first chunk above the chunks of splats, and slot there of a cell's root.
fn leafAbove(parameters: MergeParameters, cell: u32, root: u32) -> vec2u {
  let place = cell - parameters.levelStart;
  let above = parameters.nextLevelStart + place / CELL_CHILDREN - parameters.upperStart;
  return vec2u(2u * above, CELL_ROOTS * (place % CELL_CHILDREN) + root);
}

/// Bits of word number `word` that come before bit number `end` of all words.
fn countBitsBefore(bits: u32, word: u32, end: u32) -> u32 {
  return countOneBits(extractBits(bits, 0u, clamp(end, 32u * word, 32u * word + 32u) - 32u * word));
}
