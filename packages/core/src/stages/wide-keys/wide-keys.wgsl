// Computes the sort key of every visible splat in 64 bits: its depth, or the square of its distance,
// exactly as float64 has it. Reads the page's plan, the visible splats, the geometry, and the
// page's place in float64; writes both words of the keys in the order of visibleSplats. One thread
// per visible splat, dispatched per page as project; with INSTANCES, per batch of instances.
import constants::CHUNK_SPLATS;
import constants::PLACES;
import constants::PROJECT_WORKGROUP;
@if(SPLAT_EFFECTS) import effects::changeSplat;
@if(SPLAT_EFFECTS && !GEOMETRY_F32) import layout::Chunk;
@if(!INSTANCES) import layout::Page;
import layout::PagePlan;
import layout::View;
import layout::WidePlace;
import package::lib::dispatch::linearWorkgroup;
import package::lib::float64::{float64Of, negated64, orderedWords64, product64, sum64};
@if(INSTANCES) import package::lib::instances::{enterInstance, instanceIndex, page, pages};
import package::lib::packing::GEOMETRY_VECTORS;
@if(SPLAT_EFFECTS) import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> view: View;
@if(!INSTANCES) @group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read> visibleSplats: array<u32>;
/// Of each instance.
@group(0) @binding(4) var<uniform> widePlaces: array<WidePlace, PLACES>;
@group(0) @binding(5) var<storage, read> geometry: array<array<vec4u, GEOMETRY_VECTORS>>;
@group(0) @binding(6) var<storage, read_write> keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> upperKeys: array<u32>;
@if(SPLAT_EFFECTS && !GEOMETRY_F32) @group(0) @binding(9) var<storage, read> chunks: array<Chunk>;

@compute @workgroup_size(PROJECT_WORKGROUP)
fn wideKeys(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  @if(INSTANCES) page.index = pages[0].index;
  let plan = pagePlans[page.index];
  let indexInPage = linearWorkgroup(workgroup, view.dispatchRow) * PROJECT_WORKGROUP + lane;
  if (indexInPage >= plan.visibleCount) { return; }
  let index = plan.visibleStart + indexInPage;
  @if(INSTANCES) enterInstance(visibleSplats[index] / CHUNK_SPLATS);
  let splatIndex = visibleSplats[index] - page.chunkStart * CHUNK_SPLATS;
  @if(!INSTANCES) let place = 0u;
  @if(INSTANCES) let place = instanceIndex;

  @if(!SPLAT_EFFECTS) let position = geometry[splatIndex][0].xyz;
  @if(SPLAT_EFFECTS && !GEOMETRY_F32) let chunk = &chunks[splatIndex / CHUNK_SPLATS];
  @if(SPLAT_EFFECTS && !GEOMETRY_F32) let logScales = vec2f((*chunk).minLogScale, (*chunk).logScaleStep);
  @if(SPLAT_EFFECTS && !GEOMETRY_F32) let stored = unpackSplat(geometry[splatIndex], logScales);
  @if(SPLAT_EFFECTS && GEOMETRY_F32) let stored = unpackSplat(geometry[splatIndex]);
  @if(SPLAT_EFFECTS) let position = bitcast<vec3u>(changeSplat(stored, splatIndex).position);

  @if(!DISTANCE_ORDER) let depth = negated64(viewCoordinate(2u, position, place));
  @if(DISTANCE_ORDER) let x = viewCoordinate(0u, position, place);
  @if(DISTANCE_ORDER) let y = viewCoordinate(1u, position, place);
  @if(DISTANCE_ORDER) let z = viewCoordinate(2u, position, place);
  @if(DISTANCE_ORDER) let depth = sum64(sum64(product64(x, x), product64(y, y)), product64(z, z));
  let words = orderedWords64(depth);
  let farthestHigh = widePlaces[place].farthestHigh;
  keys[index] = ~words.x;
  upperKeys[index] = farthestHigh - min(farthestHigh, words.y);
}

/// One view coordinate of a position, given by the bits of its float32 coordinates. The reference
/// has the same operations in the same order, so that the result has the same bits.
fn viewCoordinate(row: u32, position: vec3u, place: u32) -> vec2u {
  let first = widePlaces[place].rows[2u * row];
  let second = widePlaces[place].rows[2u * row + 1u];
  let ofX = product64(first.xy, float64Of(position.x));
  let ofY = product64(first.zw, float64Of(position.y));
  let ofZ = product64(second.xy, float64Of(position.z));
  return sum64(sum64(sum64(ofX, ofY), ofZ), second.zw);
}
