// Opacity of a blob where splats are dilated: dilation adds the more light the smaller they are, so
// the blob is as opaque as its splats together would be at this distance. Not where
// something else removes the light that dilation adds. Reference: reference/dilated-blob.ts.
import constants::MOST_OPACITY;
import layout::View;
import package::lib::merged_splat::{meanArea, rimLength};
import package::lib::packing::Splat;

/// Where a cloud lies in view space, and how wide its splats are made.
struct BlobPlace { linear: mat3x3f, translation: vec3f, dilationPx2: f32 }

/// A blob as opaque as its dilated splats. `words` are the blob's geometry, whose last ones are the
/// sums of its splats.
fn dilatedBlob(view: View, place: BlobPlace, words: array<vec4u, 4>, blob: Splat) -> Splat {
  // Of a length in the cloud, on average over its directions.
  let stretch = pow(abs(determinant(place.linear)), 1.0 / 3.0);
  @if(ORTHOGRAPHIC) let depth = 1.0;
  @if(!ORTHOGRAPHIC) let depth = max(-(place.linear * blob.position + place.translation).z, 1e-30);
  let pxPerUnit = sqrt(abs(view.focalPx.x * view.focalPx.y)) * stretch / depth;
  let area = meanArea(blob.scale);
  let sums = bitcast<vec2f>(vec2u(words[2].w, words[3].w));
  var dilated = blob;
  let opacity = dilatedOpacity(blob.opacity, area, rimLength(blob.scale, area), sums, sqrt(place.dilationPx2), pxPerUnit);
  // From afar it tends to the number of splats, which no record holds.
  dilated.opacity = min(opacity, MOST_OPACITY);
  return dilated;
}

/// Opacity of a dilated blob: the light of its dilated splats over its own dilated area. `area` is its
/// mean area and `rim` its rim (lib/merged-splat.wgsl), in cloud units; `sums` are sums over its splats.
/// `deviationPx` is the dilation's standard deviation in pixels; `pxPerUnit` is pixels per cloud unit.
fn dilatedOpacity(opacity: f32, area: f32, rim: f32, sums: vec2f, deviationPx: f32, pxPerUnit: f32) -> f32 {
  // A unit has no size where the cloud has no extent. Squares stay within float32's range.
  let dilation = deviationPx / max(pxPerUnit, 1e-15);
  let light = opacity * area + dilation * (sums.x + dilation * sums.y);
  return light / (area + dilation * (rim + dilation));
}
