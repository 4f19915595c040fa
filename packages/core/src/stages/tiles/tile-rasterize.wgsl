// Blends the splats of each tile front to back, in float32, and writes the layer. Reads each bin's
// sorted pairs, the tiles that they may touch, and the records; writes every pixel of the layer,
// and its median depth if requested. One workgroup per tile, from the grid's first on; each thread
// blends TILE_PIXELS pixels, one above the other. With NARROW each thread reads the tile's splats
// by itself, without workgroup memory: where few threads run in lockstep, barriers and shared lists
// cost more than that. Otherwise the threads load batches of splats together. A pixel ends when
// less than 2⁻¹⁶ of the light behind passes through: less than that share of the brightest colour
// behind is left out.
import constants::BIN_TILES;
import constants::MASK_GROUP;
@if(!NARROW) import constants::TILE_BATCH;
import constants::TILE_PIXELS;
import constants::TILE_PX;
import constants::TILE_THREADS;
@if(DEPTH_TEST) import layout::HostDepth;
import layout::SplatRecord;
import layout::TileGrid;
import layout::TilePlan;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
@if(DEPTH_TEST) import package::lib::host_depth::{DEPTH_ROUNDING, centralDepth};
import package::lib::layer_rounding::rounded;
import package::lib::splat_record::{colorOf, fragmentAlpha, localCoordinate, localGradients, opacityOf};
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
/// From each pixel of a thread to the one below.
const STEP_PX = TILE_PX / TILE_PIXELS;
/// Less light than this passes through a pixel that ends.
const OPAQUE = 0.0000152587890625;

/// A splat as a tile's pixels read it.
struct TileSplat {
  /// See `localGradients`.
  gradients: vec4f,
  /// Centre; opacity; depth as the host stores it in the middle of the image.
  place: vec4f,
  /// r, g, b, view depth.
  color: vec4f,
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

/// The window's words of the masks: a bit per pair that may touch the tile, front to back.
@if(!NARROW) var<workgroup> words: array<u32, TILE_THREADS>;
/// Number of bits in each word and all words before it.
@if(!NARROW) var<workgroup> ends: array<u32, TILE_THREADS>;
@if(!NARROW) var<workgroup> batch: array<TileSplat, TILE_BATCH>;
/// Whether any pixel of the tile has not ended.
@if(!NARROW) var<workgroup> isOpen: atomic<u32>;

@compute @workgroup_size(TILE_THREADS)
fn tileRasterize(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = grid.firstTile + linearWorkgroup(workgroup, view.dispatchRow);
  if (index >= grid.binColumns * grid.binRows * TILES) { return; }
  let bin = binOrder[index / TILES];
  let tile = index % TILES;
  let origin = (vec2u(bin % grid.binColumns, bin / grid.binColumns) * BIN_TILES + vec2u(tile % BIN_TILES, tile / BIN_TILES)) * TILE_PX;
  if (any(origin >= grid.sizePx)) { return; }
  let cell = origin + vec2u(lane % TILE_PX, lane / TILE_PX);
  let center = vec2f(cell) + 0.5;
  var pixels: array<Pixel, TILE_PIXELS>;
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    pixels[p] = emptyPixel(cell + vec2u(0u, p * STEP_PX));
  }

  let block = (origin / TILE_PX) >> vec2u(tilePlan.binShift);
  let place = block % BIN_TILES;
  let listed = (block.y / BIN_TILES) * columnCount(grid, tilePlan.binShift) + block.x / BIN_TILES;
  let list = TileList(place.y * BIN_TILES + place.x, binStarts[listed], binStarts[listed + 1u]);
  @if(!NARROW) blendTogether(&pixels, center, list, lane);
  @if(NARROW) blendAlone(&pixels, center, list);
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    store(cell + vec2u(0u, p * STEP_PX), pixels[p]);
  }
}

/// Blends the pairs of a list that may touch a tile, until all of its pixels have ended.
@if(!NARROW)
fn blendTogether(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, center: vec2f, list: TileList, lane: u32) {
  let windowEnd = (list.beyondLast + 31u) / 32u;
  for (var window = list.first / 32u; window < windowEnd; window += TILE_THREADS) {
    loadWindow(lane, maskOf(list, window + lane));
    let length = workgroupUniformLoad(&ends[TILE_THREADS - 1u]);
    for (var first = 0u; first < length; first += TILE_BATCH) {
      let count = min(TILE_BATCH, length - first);
      for (var i = lane; i < TILE_BATCH; i += TILE_THREADS) { loadSplat(window, first, i, count); }
      if (lane == 0u) { atomicStore(&isOpen, 0u); }
      workgroupBarrier();
      for (var i = 0u; i < count; i += 4u) {
        // All reads first: they take longer than the arithmetic for one splat.
        let splat0 = batch[i];
        let splat1 = batch[i + 1u];
        let splat2 = batch[i + 2u];
        let splat3 = batch[i + 3u];
        blend(pixels, center, splat0);
        blend(pixels, center, splat1);
        blend(pixels, center, splat2);
        blend(pixels, center, splat3);
      }
      if (isAnyOpen(pixels, batch[count - 1u])) { atomicStore(&isOpen, 1u); }
      if (workgroupUniformLoad(&isOpen) == 0u) { return; }
    }
  }
}

/// Blends the pairs of a list that may touch a tile, until this thread's pixels have ended.
@if(NARROW)
fn blendAlone(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, center: vec2f, list: TileList) {
  let wordEnd = (list.beyondLast + 31u) / 32u;
  for (var word = list.first / 32u; word < wordEnd; word++) {
    var mask = maskOf(list, word);
    var splat: TileSplat;
    let count = countOneBits(mask);
    for (var i = 0u; i < count; i++) {
      splat = tileSplatOf(records[sortedRecords[word * 32u + firstTrailingBit(mask)]]);
      mask &= mask - 1u;
      blend(pixels, center, splat);
    }
    if (count > 0u && !isAnyOpen(pixels, splat)) { return; }
  }
}

/// Word of the masks of a tile: a bit per pair of the list that may touch the tile, front to back.
fn maskOf(list: TileList, word: u32) -> u32 {
  if (word * 32u >= list.beyondLast) { return 0u; }
  let mask = tileMasks[((word / WORDS) * TILES + list.tile) * WORDS + word % WORDS];
  // The first and the last word may hold pairs of other bins.
  let first = max(list.first, word * 32u) - word * 32u;
  let beyond = min(list.beyondLast, word * 32u + 32u) - word * 32u;
  return mask & extractBits(0xffffffffu, 0u, beyond) & ~extractBits(0xffffffffu, 0u, first);
}

/// Takes this thread's word of a window of masks.
@if(!NARROW)
fn loadWindow(lane: u32, mask: u32) {
  words[lane] = mask;
  ends[lane] = countOneBits(mask);
  for (var step = 1u; step < TILE_THREADS; step <<= 1u) {
    workgroupBarrier();
    var before = 0u;
    if (lane >= step) { before = ends[lane - step]; }
    workgroupBarrier();
    ends[lane] += before;
  }
}

/// Place of the window's set bit `index`.
@if(!NARROW)
fn pairOf(index: u32) -> u32 {
  // The first word that ends behind the bit.
  var word = 0u;
  for (var step = TILE_THREADS / 2u; step > 0u; step >>= 1u) {
    if (ends[word + step - 1u] <= index) { word += step; }
  }
  var rest = words[word];
  var skip = index + countOneBits(rest) - ends[word];
  var bit = 0u;
  for (var width = 16u; width > 0u; width >>= 1u) {
    let below = countOneBits(extractBits(rest, bit, width));
    if (skip >= below) {
      skip -= below;
      bit += width;
    }
  }
  return word * 32u + bit;
}

/// Loads a splat of a batch: the window's pair `first` + `i`. Empty ones fill up batches of four.
@if(!NARROW)
fn loadSplat(window: u32, first: u32, i: u32, count: u32) {
  var splat: TileSplat;
  if (i < count) { splat = tileSplatOf(records[sortedRecords[window * 32u + pairOf(first + i)]]); }
  batch[i] = splat;
}

fn tileSplatOf(splat: SplatRecord) -> TileSplat {
  @if(!DEPTH_TEST) let depth = 0.0;
  @if(DEPTH_TEST) let depth = centralDepth(splat.depthView, hostDepth);
  return TileSplat(
    localGradients(splat),
    vec4f(splat.centerPx, opacityOf(splat), depth),
    vec4f(colorOf(splat), splat.depthView),
  );
}

/// Blends a splat behind a thread's pixels; `center` is the uppermost one's.
fn blend(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, center: vec2f, splat: TileSplat) {
  let local = localCoordinate(splat.gradients, center - splat.place.xy);
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    (*pixels)[p] = blendPixel((*pixels)[p], local + f32(p * STEP_PX) * splat.gradients.yw, splat);
  }
}

/// `local` is the pixel's place in units of the splat's axes.
fn blendPixel(pixel: Pixel, local: vec2f, splat: TileSplat) -> Pixel {
  var blended = pixel;
  var alpha = fragmentAlpha(splat.place.z, local, view.alphaCutoff);
  @if(DEPTH_TEST) alpha = select(0.0, alpha, splat.place.w >= pixel.range.x && splat.place.w <= pixel.range.y);
  let weight = alpha * pixel.transmittance;
  blended.color += splat.color.rgb * weight;
  blended.transmittance -= weight;
  @if(DEPTH_LAYER) blended.depthView = select(pixel.depthView, splat.color.w, alpha > 0.0 && pixel.transmittance > 0.5);
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
  @if(DEPTH_TEST && !SHORT_KEYS && !REVERSED_DEPTH) return isClear && last.place.w <= pixel.range.y;
  @if(DEPTH_TEST && !SHORT_KEYS && REVERSED_DEPTH) return isClear && last.place.w >= pixel.range.x;
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
