// Walks each tile's list of splats once more, for each pixel by itself, after a frame has been
// drawn. Reads the lists and the records of the frame. One workgroup per tile, one thread per
// pixel. Counts, for each pixel, the splats that it looks at and blends until it ends, and all that
// reach it; writes the length of each tile's list; and adds up each splat's contribution: the sum
// of its weights over all pixels. Sums are integers of 64 bits, so that they are the same in any
// order of additions and never overflow. With CONTRIBUTIONS: reads the sums, and writes for each
// pixel the mean of their logarithms, by weight, and how many splats with their centres there are
// not seen anywhere.
import constants::BIN_TILES;
import constants::CONTRIBUTION_UNITS;
import constants::MASK_GROUP;
import constants::TILE_PX;
@if(CONTRIBUTIONS) import constants::UNSEEN_UNITS;
import layout::SplatRecord;
import layout::TileGrid;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::splat_record::{fragmentAlpha, localCoordinate, localGradients, opacityOf};

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> grid: TileGrid;
@group(0) @binding(2) var<storage, read> binStarts: array<u32>;
@group(0) @binding(3) var<storage, read> tileMasks: array<u32>;
@group(0) @binding(4) var<storage, read> sortedRecords: array<u32>;
@group(0) @binding(5) var<storage, read> records: array<SplatRecord>;
/// Two words per record, the lower one first.
@if(!CONTRIBUTIONS) @group(0) @binding(6) var<storage, read_write> contributions: array<atomic<u32>>;
@if(CONTRIBUTIONS) @group(0) @binding(6) var<storage, read> contributions: array<u32>;
/// Three planes of a word per pixel.
@group(0) @binding(7) var<storage, read_write> pixels: array<u32>;
@if(!CONTRIBUTIONS) @group(0) @binding(8) var<storage, read_write> tileEntries: array<u32>;

const TILES = BIN_TILES * BIN_TILES;
const WORDS = MASK_GROUP / 32u;
/// A pixel ends when less light than this passes through, as in tile-rasterize.
const OPAQUE = 0.0000152587890625;

/// A pixel's progress through its tile's list.
struct Pixel {
  transmittance: f32,
  @if(!CONTRIBUTIONS) steps: u32,
  @if(!CONTRIBUTIONS) blended: u32,
  @if(!CONTRIBUTIONS) fragments: u32,
  @if(CONTRIBUTIONS) weightedLogs: f32,
  @if(CONTRIBUTIONS) unseen: u32,
}

/// Records of a word of the list, and their contributions to the tile's pixels.
@if(!CONTRIBUTIONS) var<workgroup> owners: array<u32, 32>;
@if(!CONTRIBUTIONS) var<workgroup> sums: array<atomic<u32>, 32>;

@compute @workgroup_size(TILE_PX, TILE_PX)
fn tileCosts(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_id) place: vec3u) {
  let tileColumns = (grid.sizePx.x + TILE_PX - 1u) / TILE_PX;
  let index = linearWorkgroup(workgroup, view.dispatchRow);
  let tile = vec2u(index % tileColumns, index / tileColumns);
  if (tile.y * TILE_PX >= grid.sizePx.y) { return; }
  let bin = (tile.y / BIN_TILES) * grid.binColumns + tile.x / BIN_TILES;
  let tileOfBin = (tile.y % BIN_TILES) * BIN_TILES + tile.x % BIN_TILES;
  let cell = tile * TILE_PX + place.xy;
  let lane = place.y * TILE_PX + place.x;
  let isInside = all(cell < grid.sizePx);
  var pixel: Pixel;
  pixel.transmittance = select(0.0, 1.0, isInside);

  let first = binStarts[bin];
  let beyondLast = binStarts[bin + 1u];
  var entries = 0u;
  let wordEnd = (beyondLast + 31u) / 32u;
  for (var word = first / 32u; word < wordEnd; word++) {
    var mask = maskOf(word, tileOfBin, first, beyondLast);
    let count = countOneBits(mask);
    for (var i = 0u; i < count; i++) {
      let record = sortedRecords[word * 32u + firstTrailingBit(mask)];
      mask &= mask - 1u;
      pixel = passed(pixel, cell, record, i);
      @if(!CONTRIBUTIONS) owners[i] = record;
    }
    entries += count;
    @if(!CONTRIBUTIONS) workgroupBarrier();
    @if(!CONTRIBUTIONS) addSum(lane, count);
    @if(!CONTRIBUTIONS) workgroupBarrier();
  }
  @if(!CONTRIBUTIONS) tileEntries[index] = entries;
  if (isInside) { store(cell, pixel); }
}

/// Word of the masks of a tile, without the bits of other bins' pairs.
fn maskOf(word: u32, tile: u32, first: u32, beyondLast: u32) -> u32 {
  let mask = tileMasks[((word / WORDS) * TILES + tile) * WORDS + word % WORDS];
  let begin = max(first, word * 32u) - word * 32u;
  let end = min(beyondLast, word * 32u + 32u) - word * 32u;
  return mask & extractBits(0xffffffffu, 0u, end) & ~extractBits(0xffffffffu, 0u, begin);
}

/// A pixel after the next splat of its list, the one of bit `i` of a word.
fn passed(before: Pixel, cell: vec2u, record: u32, i: u32) -> Pixel {
  var pixel = before;
  let splat = records[record];
  let local = localCoordinate(localGradients(splat), vec2f(cell) + 0.5 - splat.centerPx);
  let alpha = fragmentAlpha(opacityOf(splat), local, view.alphaCutoff);
  let isOpen = pixel.transmittance >= OPAQUE;
  let weight = select(0.0, alpha * pixel.transmittance, isOpen);
  pixel.transmittance -= weight;
  @if(!CONTRIBUTIONS) pixel.steps += u32(isOpen);
  @if(!CONTRIBUTIONS) pixel.blended += u32(weight > 0.0);
  @if(!CONTRIBUTIONS) pixel.fragments += u32(alpha > 0.0);
  // Records that the pixel does not see add nothing.
  @if(!CONTRIBUTIONS) if (weight > 0.0) { atomicAdd(&sums[i], u32(weight * f32(CONTRIBUTION_UNITS) + 0.5)); }
  @if(CONTRIBUTIONS) let units = vec2u(contributions[2u * record], contributions[2u * record + 1u]);
  @if(CONTRIBUTIONS) pixel.weightedLogs += weight * logOf(units);
  @if(CONTRIBUTIONS) pixel.unseen += u32(all(units < vec2u(UNSEEN_UNITS, 1u)) && all(floor(splat.centerPx) == vec2f(cell)));
  return pixel;
}

/// Adds each record's contribution to the tile to its contribution to the picture; a thread per bit.
@if(!CONTRIBUTIONS)
fn addSum(lane: u32, count: u32) {
  if (lane >= count) { return; }
  let sum = atomicExchange(&sums[lane], 0u);
  if (sum == 0u) { return; }
  let low = 2u * owners[lane];
  if (atomicAdd(&contributions[low], sum) > 0xffffffffu - sum) { atomicAdd(&contributions[low + 1u], 1u); }
}

/// Logarithm to base 2 of a contribution in pixels; at least the logarithm of one unit.
@if(CONTRIBUTIONS)
fn logOf(units: vec2u) -> f32 {
  return log2(max((f32(units.y) * 4294967296.0 + f32(units.x)) / f32(CONTRIBUTION_UNITS), 1.0 / f32(CONTRIBUTION_UNITS)));
}

fn store(cell: vec2u, pixel: Pixel) {
  let at = cell.y * grid.sizePx.x + cell.x;
  let plane = grid.sizePx.x * grid.sizePx.y;
  @if(!CONTRIBUTIONS) pixels[at] = pixel.steps;
  @if(!CONTRIBUTIONS) pixels[plane + at] = pixel.blended;
  @if(!CONTRIBUTIONS) pixels[2u * plane + at] = pixel.fragments;
  @if(CONTRIBUTIONS) let opacity = 1.0 - pixel.transmittance;
  @if(CONTRIBUTIONS) pixels[at] = bitcast<u32>(select(0.0, pixel.weightedLogs / opacity, opacity > 0.0));
  @if(CONTRIBUTIONS) pixels[plane + at] = bitcast<u32>(opacity);
  @if(CONTRIBUTIONS) pixels[2u * plane + at] = pixel.unseen;
}
