// Blends the splats of each tile, and writes every pixel of the layer, and its median depth if
// requested. One workgroup per tile, from the grid's first on; see tile-blend. With SPLIT, no long list
// holds up a frame: a tile that is still open after FRONT_SPLATS of them is left to tile-rest.
@if(SPLIT) import constants::FRONT_SPLATS;
import constants::TILE_PIXELS;
import constants::TILE_THREADS;
import package::lib::dispatch::linearWorkgroup;
import package::lib::tile_blend::{STEP_PX, emptyPixels, grid, listOf, originOf, placeOf, store, tileCount, view};
@if(NARROW) import package::lib::tile_blend::blendAlone;
@if(!NARROW) import package::lib::tile_blend::{Pixel, TileList, batch, blendBatch, ends, isAnyOpen, loadSplat, loadWindow, maskOf, wordEndOf};

/// Number of tiles that are left; a count of tile-rest; of each tile, its number and the first word that is
/// left of its list.
@if(SPLIT) @group(0) @binding(12) var<storage, read_write> longTiles: array<atomic<u32>>;
/// Pixels of the first of these tiles: colour, and the share of light that passes through.
@if(SPLIT) @group(0) @binding(13) var<storage, read_write> frontPixels: array<vec4f>;

/// Whether any pixel of the tile has not ended.
@if(!NARROW) var<workgroup> isOpen: atomic<u32>;
/// Place among the tiles that are left.
@if(SPLIT) var<workgroup> longTile: u32;

@compute @workgroup_size(TILE_THREADS)
fn tileRasterize(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = grid.firstTile + linearWorkgroup(workgroup, view.dispatchRow);
  if (index >= tileCount()) { return; }
  let origin = originOf(index);
  if (any(origin >= grid.sizePx)) { return; }
  let place = placeOf(lane);
  let cell = origin + place;
  let list = listOf(origin);
  var pixels = emptyPixels(cell);
  @if(NARROW) blendAlone(&pixels, origin, vec2f(place), list);
  @if(!NARROW) let left = blendTogether(&pixels, origin, vec2f(place), list, lane);
  @if(SPLIT) if (left != 0u) {
    leave(pixels, index, left, lane);
    return;
  }
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    store(cell + vec2u(0u, p * STEP_PX), pixels[p]);
  }
}

/// Blends the pairs of a list that may touch a tile, until all of its pixels have ended. Returns the
/// first word that is left of a long list, 0 if none is.
@if(!NARROW)
fn blendTogether(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, origin: vec2u, place: vec2f, list: TileList, lane: u32) -> u32 {
  let firstWord = list.first / 32u;
  let windows = (wordEndOf(list) - firstWord + TILE_THREADS - 1u) / TILE_THREADS;
  @if(SPLIT) var blended = 0u;
  for (var i = 0u; i < windows; i++) {
    let window = firstWord + i * TILE_THREADS;
    @if(SPLIT) if (blended >= FRONT_SPLATS) { return window; }
    loadWindow(0u, lane, maskOf(list, window + lane));
    let length = workgroupUniformLoad(&ends[0][TILE_THREADS - 1u]);
    let batches = (length + TILE_THREADS - 1u) / TILE_THREADS;
    for (var j = 0u; j < batches; j++) {
      let first = j * TILE_THREADS;
      let count = min(TILE_THREADS, length - first);
      loadSplat(0u, lane, window, first + lane, length, origin);
      if (lane == 0u) { atomicStore(&isOpen, 0u); }
      workgroupBarrier();
      blendBatch(pixels, place, 0u, count);
      if (isAnyOpen(pixels, batch[0][count - 1u])) { atomicStore(&isOpen, 1u); }
      if (workgroupUniformLoad(&isOpen) == 0u) { return 0u; }
    }
    @if(SPLIT) blended += length;
  }
  return 0u;
}

/// Leaves a tile to tile-rest, which blends it from its beginning if there is no room for its pixels.
@if(SPLIT)
fn leave(pixels: array<Pixel, TILE_PIXELS>, tile: u32, word: u32, lane: u32) {
  if (lane == 0u) {
    longTile = atomicAdd(&longTiles[0], 1u);
    atomicStore(&longTiles[2u + 2u * longTile], tile);
    atomicStore(&longTiles[3u + 2u * longTile], word);
  }
  let first = workgroupUniformLoad(&longTile) * TILE_THREADS * TILE_PIXELS;
  if (first + TILE_THREADS * TILE_PIXELS > arrayLength(&frontPixels)) { return; }
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    frontPixels[first + p * TILE_THREADS + lane] = vec4f(pixels[p].color, pixels[p].transmittance);
  }
}
