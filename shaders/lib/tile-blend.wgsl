// Blends the splats of a tile front to back, in float32. Reads each bin's sorted pairs, the tiles that
// they may touch, and the records.
// Each of TILE_THREADS threads blends TILE_PIXELS pixels, one above the other. With NARROW each thread
// reads the tile's splats by itself, without workgroup memory: where few threads run in lockstep,
// barriers and shared lists cost more than that. Otherwise the threads load batches of splats
// together; a workgroup may have several teams of them. A pixel ends when less than 2⁻¹⁶ of the light
// behind passes through: less than that share of the brightest colour behind is left out.
import constants::BIN_TILES;
@if(!NARROW) import constants::BIT_STEPS;
import constants::MASK_GROUP;
import constants::TILE_PIXELS;
import constants::TILE_PX;
@if(!NARROW) import constants::TILE_STEPS;
@if(!NARROW) import constants::TILE_TEAMS;
import constants::TILE_THREADS;
@if(DEPTH_TEST) import layout::HostDepth;
import layout::SplatRecord;
import layout::TileGrid;
import layout::TilePlan;
import layout::View;
@if(DEPTH_TEST) import package::lib::host_depth::{DEPTH_ROUNDING, centralDepth};
import package::lib::layer_rounding::rounded;
import package::lib::splat_record::{colorOf, columnGradients, drawnAlpha, opacityOf};
@if(STACKED) import package::lib::stacked_opacity::stackedAlpha;
import package::lib::tile_grid::columnCount;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> grid: TileGrid;
@group(0) @binding(2) var<storage, read> tilePlan: TilePlan;
@group(0) @binding(3) var<storage, read> binStarts: array<u32>;
@group(0) @binding(4) var<storage, read> binOrder: array<u32>;
@group(0) @binding(5) var<storage, read> tileMasks: array<u32>;
@group(0) @binding(6) var<storage, read> sortedRecords: array<u32>;
@group(0) @binding(7) var<storage, read> records: array<SplatRecord>;
@if(LAYER_F32) @group(0) @binding(8) var layer: texture_storage_2d<rgba32float, write>;
@if(LAYER_F16) @group(0) @binding(8) var layer: texture_storage_2d<rgba16float, write>;
@if(!LAYER_F32 && !LAYER_F16) @group(0) @binding(8) var layer: texture_storage_2d<rgba8unorm, write>;
@if(DEPTH_TEST) @group(0) @binding(9) var<uniform> hostDepth: HostDepth;
@if(DEPTH_TEST) @group(0) @binding(10) var testedDepth: texture_depth_2d;
@if(DEPTH_LAYER) @group(0) @binding(11) var depthLayer: texture_storage_2d<r32float, write>;

const TILES = BIN_TILES * BIN_TILES;
const WORDS = MASK_GROUP / 32u;
/// Splats are blended four at a time.
@if(!NARROW) const FOURS = TILE_THREADS / 4u;
/// From each pixel of a thread to the one below.
const STEP_PX = TILE_PX / TILE_PIXELS;
/// Standard deviations, and more, from a splat that draws nothing.
@if(!NARROW) const FAR_AWAY = 1000.0;
/// Less light than this passes through a pixel that ends.
const OPAQUE = 0.0000152587890625;

/// A splat as a tile's pixels read it.
struct TileSplat {
  /// At a column and a row of the tile, u = x·column + y·row + z, v = w·column + vAtLeft: see
  /// `columnGradients`.
  gradients: vec4f,
  /// r, g, b; log2 of the opacity, or the opacity itself where splats may be merged ones.
  color: vec4f,
  vAtLeft: f32,
  /// Depth as the host stores it in the middle of the image.
  @if(DEPTH_TEST) depth: f32,
  @if(DEPTH_LAYER) depthView: f32,
}

/// The pairs of a tile's bin.
struct TileList {
  /// Index of the tile within its bin; of its block of tiles, where bins are larger.
  tile: u32,
  first: u32,
  beyondLast: u32,
}

struct Pixel {
  color: vec3f,
  /// Share of the light behind that passes through.
  transmittance: f32,
  /// Least and greatest depth that is drawn here, as the host stores it in the middle of the image.
  @if(DEPTH_TEST) range: vec2f,
  /// View depth of the splat that makes the pixel more than half covered, or of the last so far.
  @if(DEPTH_LAYER) depthView: f32,
}

/// Of each team of threads, a window's words of the masks: a bit per pair that may touch the tile, front
/// to back.
@if(!NARROW) var<workgroup> words: array<array<u32, TILE_THREADS>, TILE_TEAMS>;
/// Number of bits in each word and all words before it in its window.
@if(!NARROW) var<workgroup> ends: array<array<u32, TILE_THREADS>, TILE_TEAMS>;
@if(!NARROW) var<workgroup> batch: array<array<TileSplat, TILE_THREADS>, TILE_TEAMS>;

/// Number of tiles of all bins; some of the outer ones lie outside of the image.
fn tileCount() -> u32 {
  return grid.binColumns * grid.binRows * TILES;
}

/// Uppermost left pixel of the tile that is drawn as number `index`.
fn originOf(index: u32) -> vec2u {
  let bin = binOrder[index / TILES];
  let tile = index % TILES;
  return (vec2u(bin % grid.binColumns, bin / grid.binColumns) * BIN_TILES + vec2u(tile % BIN_TILES, tile / BIN_TILES)) * TILE_PX;
}

fn listOf(origin: vec2u) -> TileList {
  let block = (origin / TILE_PX) >> vec2u(tilePlan.binShift);
  let place = block % BIN_TILES;
  let listed = (block.y / BIN_TILES) * columnCount(grid, tilePlan.binShift) + block.x / BIN_TILES;
  return TileList(place.y * BIN_TILES + place.x, binStarts[listed], binStarts[listed + 1u]);
}

/// The word behind the last one of a list.
fn wordEndOf(list: TileList) -> u32 {
  return (list.beyondLast + 31u) / 32u;
}

/// Column and row, within its tile, of a thread's uppermost pixel.
fn placeOf(lane: u32) -> vec2u {
  return vec2u(lane % TILE_PX, lane / TILE_PX);
}

fn emptyPixels(cell: vec2u) -> array<Pixel, TILE_PIXELS> {
  var pixels: array<Pixel, TILE_PIXELS>;
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    pixels[p] = emptyPixel(cell + vec2u(0u, p * STEP_PX));
  }
  return pixels;
}

/// Blends the first `count` splats of a team's batch.
@if(!NARROW)
fn blendBatch(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, place: vec2f, team: u32, count: u32) {
  // To a constant, so that Dawn need not keep each index in range.
  for (var four = 0u; four < FOURS; four++) {
    let i = 4u * four;
    if (i >= count) { break; }
    // All reads first: they take longer than the arithmetic for one splat.
    let splat0 = batch[team][i];
    let splat1 = batch[team][i + 1u];
    let splat2 = batch[team][i + 2u];
    let splat3 = batch[team][i + 3u];
    blend(pixels, place, splat0);
    blend(pixels, place, splat1);
    blend(pixels, place, splat2);
    blend(pixels, place, splat3);
  }
}

/// Blends the pairs of a list that may touch a tile, until this thread's pixels have ended.
@if(NARROW)
fn blendAlone(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, origin: vec2u, place: vec2f, list: TileList) {
  let wordEnd = wordEndOf(list);
  for (var word = list.first / 32u; word < wordEnd; word++) {
    var mask = maskOf(list, word);
    var splat: TileSplat;
    let count = countOneBits(mask);
    for (var i = 0u; i < count; i++) {
      splat = tileSplatOf(records[sortedRecords[word * 32u + firstTrailingBit(mask)]], origin);
      mask &= mask - 1u;
      blend(pixels, place, splat);
    }
    if (count > 0u && !isAnyOpen(pixels, splat)) { return; }
  }
}

/// Word of the masks of a tile: a bit per pair of the list that may touch the tile, front to back.
fn maskOf(list: TileList, word: u32) -> u32 {
  if (word * 32u >= list.beyondLast) { return 0u; }
  let mask = tileMasks[((word / WORDS) * TILES + list.tile) * WORDS + word % WORDS];
  // The first and the last word may hold pairs of other bins.
  let before = max(list.first, word * 32u) - word * 32u;
  let behind = 32u - min(32u, list.beyondLast - word * 32u);
  return mask & (0xffffffffu << before) & (0xffffffffu >> behind);
}

/// Takes this thread's word of its team's window of masks.
@if(!NARROW)
fn loadWindow(team: u32, lane: u32, mask: u32) {
  words[team][lane] = mask;
  var end = countOneBits(mask);
  @unroll for (var step = 0u; step < TILE_STEPS; step++) {
    ends[team][lane] = end;
    workgroupBarrier();
    if (lane >= (1u << step)) { end += ends[team][lane - (1u << step)]; }
    workgroupBarrier();
  }
  ends[team][lane] = end;
}

/// Place of the window's set bit `index`.
@if(!NARROW)
fn pairOf(team: u32, index: u32) -> u32 {
  // The first word that ends behind the bit.
  var word = 0u;
  @unroll for (var step = 0u; step < TILE_STEPS; step++) {
    let half = u32(TILE_THREADS) >> (step + 1u);
    if (ends[team][word + half - 1u] <= index) { word += half; }
  }
  let bits = words[team][word];
  var skip = index + countOneBits(bits) - ends[team][word];
  var bit = 0u;
  @unroll for (var step = 0u; step < BIT_STEPS; step++) {
    let half = 16u >> step;
    let below = countOneBits((bits >> bit) & ((1u << half) - 1u));
    if (skip >= below) {
      skip -= below;
      bit += half;
    }
  }
  return word * 32u + bit;
}

/// Loads this thread's splat of a batch: set bit `index` of the window's `count`. Empty splats fill up
/// batches of four.
@if(!NARROW)
fn loadSplat(team: u32, lane: u32, window: u32, index: u32, count: u32, origin: vec2u) {
  var splat: TileSplat;
  splat.vAtLeft = FAR_AWAY;
  if (index < count) { splat = tileSplatOf(records[sortedRecords[window * 32u + pairOf(team, index)]], origin); }
  batch[team][lane] = splat;
}

fn tileSplatOf(splat: SplatRecord, origin: vec2u) -> TileSplat {
  let gradients = columnGradients(splat);
  let offset = vec2f(origin) + 0.5 - splat.centerPx;
  var tileSplat: TileSplat;
  tileSplat.gradients = vec4f(gradients.xy, dot(gradients.xy, offset), gradients.z);
  tileSplat.vAtLeft = gradients.z * offset.x;
  @if(STACKED) tileSplat.color = vec4f(colorOf(splat), opacityOf(splat));
  @if(!STACKED) tileSplat.color = vec4f(colorOf(splat), log2(opacityOf(splat)));
  @if(DEPTH_TEST) tileSplat.depth = centralDepth(splat.depthView, hostDepth);
  @if(DEPTH_LAYER) tileSplat.depthView = splat.depthView;
  return tileSplat;
}

/// Blends a splat behind a thread's pixels; `place` is the column and row of the uppermost one. The
/// pixels lie in one column, so that `v` is computed once for all of them.
fn blend(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, place: vec2f, splat: TileSplat) {
  let v = splat.gradients.w * place.x + splat.vAtLeft;
  @if(!STACKED) let inColumn = v * v - splat.color.w;
  @if(STACKED) let inColumn = v * v;
  var u = splat.gradients.x * place.x + (splat.gradients.y * place.y + splat.gradients.z);
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    (*pixels)[p] = blendPixel((*pixels)[p], u * u + inColumn, splat);
    u += f32(STEP_PX) * splat.gradients.y;
  }
}

/// `halvings` is −log2 of the splat's alpha, or of its Gaussian where splats may be merged ones.
fn blendPixel(pixel: Pixel, halvings: f32, splat: TileSplat) -> Pixel {
  var blended = pixel;
  @if(!STACKED) var alpha = drawnAlpha(exp2(-halvings), view.alphaCutoff);
  @if(STACKED) var alpha = drawnAlpha(stackedAlpha(splat.color.w, exp2(-halvings)), view.alphaCutoff);
  @if(DEPTH_TEST) alpha = select(0.0, alpha, splat.depth >= pixel.range.x && splat.depth <= pixel.range.y);
  let weight = alpha * pixel.transmittance;
  blended.color += splat.color.rgb * weight;
  blended.transmittance -= weight;
  @if(DEPTH_LAYER) blended.depthView = select(pixel.depthView, splat.depthView, alpha > 0.0 && pixel.transmittance > 0.5);
  return blended;
}

/// Whether splats behind `last` may change a pixel of this thread.
fn isAnyOpen(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, last: TileSplat) -> bool {
  var isOpenHere = false;
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    isOpenHere |= isPixelOpen((*pixels)[p], last);
  }
  return isOpenHere;
}

/// Whether splats behind `last` may change a pixel.
fn isPixelOpen(pixel: Pixel, last: TileSplat) -> bool {
  let isClear = pixel.transmittance >= OPAQUE;
  // Splats come in order of depth, unless keys are short.
  @if(DEPTH_TEST && !SHORT_KEYS && !REVERSED_DEPTH) return isClear && last.depth <= pixel.range.y;
  @if(DEPTH_TEST && !SHORT_KEYS && REVERSED_DEPTH) return isClear && last.depth >= pixel.range.x;
  @if(!DEPTH_TEST || SHORT_KEYS) return isClear;
}

fn emptyPixel(cell: vec2u) -> Pixel {
  var pixel: Pixel;
  pixel.transmittance = 1.0;
  @if(DEPTH_TEST) pixel.range = drawnDepths(cell);
  return pixel;
}

/// Range of depths of splats that the host's depth does not hide at a pixel, at the image's middle.
@if(DEPTH_TEST)
fn drawnDepths(cell: vec2u) -> vec2f {
  let stored = textureLoad(testedDepth, min(cell, grid.sizePx - 1u), 0);
  let ndc = ((vec2f(cell) + 0.5) / view.sizePx * 2.0 - 1.0) * vec2f(1.0, -1.0);
  let offset = dot(hostDepth.slope, ndc);
  // Depths outside of 0…1 by rounding alone are clamped; depths farther outside are clipped.
  @if(!REVERSED_DEPTH) let range = vec2f(-DEPTH_ROUNDING, select(stored, 1.0 + DEPTH_ROUNDING, stored >= 1.0));
  @if(REVERSED_DEPTH) let range = vec2f(select(stored, -DEPTH_ROUNDING, stored <= 0.0), 1.0 + DEPTH_ROUNDING);
  return range - offset;
}

fn store(cell: vec2u, pixel: Pixel) {
  if (any(cell >= grid.sizePx)) { return; }
  textureStore(layer, cell, rounded(vec4f(pixel.color, 1.0 - pixel.transmittance)));
  // Weighted like a colour, as quads write it.
  @if(DEPTH_LAYER) textureStore(depthLayer, cell, vec4f(pixel.depthView * (1.0 - pixel.transmittance), 0.0, 0.0, 0.0));
}
