// Finds the splat that contributes most to one pixel. Reads the drawing order and the records;
// writes a PickBlock per block of PICK_WORKGROUP places of the order: the block's transmittance and
// its heaviest splat. One workgroup per block, one thread per place. The host combines the blocks
// front to back. Without a list that could overflow and without atomics, so a pick gives the same
// result every time.
import constants::PICK_WORKGROUP;
import layout::PickBlock;
import layout::PickParameters;
import layout::SplatRecord;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::splat_record::{fragmentAlpha, localCoordinate, localGradients, opacityOf};

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> parameters: PickParameters;
@group(0) @binding(2) var<storage, read> visibleCount: u32;
@group(0) @binding(3) var<storage, read> order: array<u32>;
@group(0) @binding(4) var<storage, read> visibleSplats: array<u32>;
@group(0) @binding(5) var<storage, read> records: array<SplatRecord>;
@group(0) @binding(6) var<storage, read_write> blocks: array<PickBlock>;

var<workgroup> alphas: array<f32, PICK_WORKGROUP>;

@compute @workgroup_size(PICK_WORKGROUP)
fn pick(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, view.dispatchRow);
  let first = block * PICK_WORKGROUP;
  var alpha = 0.0;
  if (first + lane < visibleCount) { alpha = alphaAtPixel(records[order[first + lane]]); }
  alphas[lane] = alpha;
  workgroupBarrier();
  if (lane > 0u || block >= parameters.blockCount) { return; }

  var transmittance = 1.0;
  var weight = 0.0;
  var heaviest = 0u;
  for (var i = 0u; i < PICK_WORKGROUP; i++) {
    // Splats are drawn back to front: the last is the foremost, and wins among equal weights.
    let place = PICK_WORKGROUP - 1u - i;
    if (alphas[place] * transmittance > weight) {
      weight = alphas[place] * transmittance;
      heaviest = place;
    }
    transmittance *= 1.0 - alphas[place];
  }
  var found = PickBlock(transmittance, weight, 0u, 0.0, 0.0, 0u);
  if (weight > 0.0) {
    let place = first + heaviest;
    let index = order[place];
    let rank = visibleCount - 1u - place;
    found = PickBlock(transmittance, weight, visibleSplats[index], alphas[heaviest], records[index].depthView, rank);
  }
  blocks[block] = found;
}

/// Opacity at the pixel; 0 where nothing is drawn.
fn alphaAtPixel(splat: SplatRecord) -> f32 {
  let local = localCoordinate(localGradients(splat), parameters.pixelPx - splat.centerPx);
  return fragmentAlpha(opacityOf(splat), local, view.alphaCutoff);
}
