// Blends the ends of long lists, which tile-rasterize leaves, and writes the pixels of these tiles. A
// workgroup takes one tile after another. Each of its TILE_TEAMS teams of threads blends a window of
// the list, all at the same time, as if nothing were in front. Then each window is dimmed by those in
// front of it. A pixel takes nothing from windows behind the one in which it ends, so that a tile's
// pixels follow from its list alone.
import constants::FRONT_SPLATS;
import constants::ROUND_SPLATS;
import constants::TILE_PIXELS;
import constants::TILE_TEAMS;
import constants::TILE_THREADS;
import package::lib::tile_blend::{OPAQUE, Pixel, STEP_PX, TileList, batch, blendBatch, emptyPixels, ends, isAnyOpen, listOf, loadSplat, loadWindow, maskOf, originOf, placeOf, store, wordEndOf, words};

/// As tile-rasterize writes them, with the number of workgroups of this stage that have ended between.
/// The last clears both numbers, as a host may have a frame drawn any number of times.
@group(0) @binding(12) var<storage, read_write> longTiles: array<atomic<u32>>;
@group(0) @binding(13) var<storage, read> frontPixels: array<vec4f>;

const THREADS = TILE_TEAMS * TILE_THREADS;

/// Of `longTiles`: the number of tiles; the tile that is drawn, and the first word that is left of its list.
var<workgroup> longTileCount: u32;
var<workgroup> tileAndWord: vec2u;

/// The most bits of a window of all teams.
var<workgroup> longest: atomic<u32>;
/// Of each team, for batches in turns: whether any pixel of its window has not ended.
var<workgroup> openTeams: array<atomic<u32>, 2 * TILE_TEAMS>;
/// Whether any pixel of the tile has not ended.
var<workgroup> isOpen: atomic<u32>;

@compute @workgroup_size(THREADS)
fn tileRest(@builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u, @builtin(local_invocation_index) thread: u32) {
  if (thread == 0u) { longTileCount = atomicLoad(&longTiles[0]); }
  let count = workgroupUniformLoad(&longTileCount);
  if (count == 0u) { return; }
  for (var i = workgroup.x; i < count; i += workgroups.x) {
    if (thread == 0u) {
      tileAndWord = vec2u(atomicLoad(&longTiles[2u + 2u * i]), atomicLoad(&longTiles[3u + 2u * i]));
    }
    let entry = workgroupUniformLoad(&tileAndWord);
    drawTile(i, entry.x, entry.y, thread % TILE_THREADS, thread / TILE_THREADS);
  }
  if (thread == 0u && atomicAdd(&longTiles[1], 1u) == workgroups.x - 1u) {
    atomicStore(&longTiles[0], 0u);
    atomicStore(&longTiles[1], 0u);
  }
}

/// Draws tile `tile`, whose front is at place `i` if there was room for it.
fn drawTile(i: u32, tile: u32, left: u32, lane: u32, team: u32) {
  let origin = originOf(tile);
  let cell = origin + placeOf(lane);
  let place = vec2f(cell - origin);
  let list = listOf(origin);
  let windowEnd = wordEndOf(list);
  var light: array<f32, TILE_PIXELS>;
  // Each team sums up its own windows; the first one begins with the front.
  var colors: array<vec3f, TILE_PIXELS>;
  var front = emptyPixels(cell);
  let firstFront = i * TILE_THREADS * TILE_PIXELS;
  if (firstFront + TILE_THREADS * TILE_PIXELS <= arrayLength(&frontPixels)) {
    @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
      let stored = frontPixels[firstFront + p * TILE_THREADS + lane];
      front[p].color = stored.rgb;
      front[p].transmittance = stored.a;
    }
  } else {
    // All teams alike.
    for (var window = list.first / 32u; window < left; window += TILE_THREADS) {
      blendWindow(&front, origin, place, list, window, TILE_THREADS, lane, team);
    }
  }
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    light[p] = front[p].transmittance;
    if (team == 0u) { colors[p] = front[p].color; }
  }
  // As many words as had ROUND_SPLATS, if the list goes on as it began.
  let length = clamp((left - list.first / 32u) * ROUND_SPLATS / FRONT_SPLATS, 1u, TILE_THREADS);
  let roundWords = TILE_TEAMS * length;
  let rounds = (windowEnd - left + roundWords - 1u) / roundWords;
  for (var round = 0u; round < rounds; round++) {
    let first = left + round * roundWords;
    var pixels = emptyPixels(cell);
    blendWindow(&pixels, origin, place, list, first + team * length, length, lane, team);
    // `blendWindow` has ended with a barrier: its words are free for the light that passes through.
    share(team, lane, vec2f(pixels[0].transmittance, pixels[1].transmittance));
    if (lane + team == 0u) { atomicStore(&isOpen, 0u); }
    workgroupBarrier();
    for (var each = 0u; each < TILE_TEAMS; each++) {
      let passed = sharedBy(each, lane);
      @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
        if (light[p] >= OPAQUE) {
          if (each == team) { colors[p] += light[p] * pixels[p].color; }
          light[p] *= passed[p];
        }
      }
    }
    if (max(light[0], light[1]) >= OPAQUE) { atomicStore(&isOpen, 1u); }
    if (workgroupUniformLoad(&isOpen) == 0u) { break; }
  }
  for (var channel = 0u; channel < 3u; channel++) {
    workgroupBarrier();
    share(team, lane, vec2f(colors[0][channel], colors[1][channel]));
    workgroupBarrier();
    var sum = vec2f(0.0);
    for (var each = 0u; each < TILE_TEAMS; each++) {
      sum += sharedBy(each, lane);
    }
    front[0].color[channel] = sum[0];
    front[1].color[channel] = sum[1];
  }
  workgroupBarrier();
  if (team != 0u) { return; }
  @unroll for (var p = 0u; p < TILE_PIXELS; p++) {
    front[p].transmittance = light[p];
    store(cell + vec2u(0u, p * STEP_PX), front[p]);
  }
}

/// Shares values of this thread's two pixels with the other teams, in the memory of the window's words.
fn share(team: u32, lane: u32, values: vec2f) {
  words[team][lane] = bitcast<u32>(values.x);
  ends[team][lane] = bitcast<u32>(values.y);
}

fn sharedBy(team: u32, lane: u32) -> vec2f {
  return vec2f(bitcast<f32>(words[team][lane]), bitcast<f32>(ends[team][lane]));
}

/// Blends the pairs of this team's window that may touch the tile. Called by all teams at the same time;
/// windows behind the end of the list are empty.
fn blendWindow(pixels: ptr<function, array<Pixel, TILE_PIXELS>>, origin: vec2u, place: vec2f, list: TileList, window: u32, length: u32, lane: u32, team: u32) {
  if (lane + team == 0u) { atomicStore(&longest, 0u); }
  var mask = 0u;
  if (lane < length) { mask = maskOf(list, window + lane); }
  loadWindow(team, lane, mask);
  if (lane == TILE_THREADS - 1u) { atomicMax(&longest, ends[team][lane]); }
  let most = workgroupUniformLoad(&longest);
  var count = ends[team][TILE_THREADS - 1u];
  let batches = (most + TILE_THREADS - 1u) / TILE_THREADS;
  for (var i = 0u; i < batches; i++) {
    let first = i * TILE_THREADS;
    let turn = TILE_TEAMS * (i % 2u) + team;
    if (lane == 0u) { atomicStore(&openTeams[turn], 0u); }
    if (first < count) { loadSplat(team, lane, window, first + lane, count, origin); }
    workgroupBarrier();
    if (first < count) {
      let loaded = min(TILE_THREADS, count - first);
      blendBatch(pixels, place, team, loaded);
      if (isAnyOpen(pixels, batch[team][loaded - 1u])) { atomicStore(&openTeams[turn], 1u); }
    }
    workgroupBarrier();
    if (atomicLoad(&openTeams[turn]) == 0u) { count = 0u; }
  }
}
