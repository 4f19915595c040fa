// Measures how far one image is from another. Reads two textures and the background; writes errors
// and dissimilarity per tile, and a count per class of error. One workgroup per tile of
// COMPARE_TILE_PX², one thread per pixel. Needs no buffer of the images' size: the Gaussian windows
// of structural similarity read the tile and its surroundings from workgroup memory.
//
// Structural similarity is computed from the sum s = a + b and the difference d = a − b of the
// images. Multiplied out, 1 − SSIM needs the variance of d, which is small where the images are
// alike and then loses nothing in float32; computed from the variances of a and b it would be the
// difference of nearly equal numbers.
import constants::COMPARE_TILE_PX;
import constants::SSIM_RADIUS_PX;
import layout::CompareParameters;
import layout::CompareTile;

const TILE_PIXELS = COMPARE_TILE_PX * COMPARE_TILE_PX;
/// The tile and the surroundings that its windows reach.
const AREA_PX = COMPARE_TILE_PX + 2 * SSIM_RADIUS_PX;
const AREA_PIXELS = AREA_PX * AREA_PX;
/// Columns of the tile, rows of the area.
const STRIP_PIXELS = COMPARE_TILE_PX * AREA_PX;
const WINDOW_PX = 2 * SSIM_RADIUS_PX + 1;
const SSIM_SIGMA_PX = 1.5;
const SSIM_C1 = 0.01 * 0.01;
const SSIM_C2 = 0.03 * 0.03;
const ERROR_DROPPED_BITS = 16u;

@group(0) @binding(0) var<uniform> parameters: CompareParameters;
@group(0) @binding(1) var actual: texture_2d<f32>;
@group(0) @binding(2) var expected: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> tiles: array<CompareTile>;
@group(0) @binding(4) var<storage, read_write> errorCounts: array<atomic<u32>>;

/// Per pixel of the area, of one channel: sum − 1, about 0, and difference; 0 outside of the image.
var<workgroup> area: array<vec2f, AREA_PIXELS>;
/// Per pixel of the strip, weighted along rows: means of sum and difference, and of their squares.
var<workgroup> strip: array<vec4f, STRIP_PIXELS>;
var<workgroup> partials: array<vec3f, TILE_PIXELS>;
var<workgroup> brokenActual: atomic<u32>;
var<workgroup> brokenExpected: atomic<u32>;

@compute @workgroup_size(COMPARE_TILE_PX, COMPARE_TILE_PX)
fn compareImages(
  @builtin(workgroup_id) workgroup: vec3u,
  @builtin(local_invocation_id) place: vec3u,
  @builtin(local_invocation_index) lane: u32,
) {
  let sizePx = vec2i(textureDimensions(actual));
  let areaStart = vec2i(workgroup.xy) * COMPARE_TILE_PX - SSIM_RADIUS_PX;
  let pixel = areaStart + vec2i(place.xy) + SSIM_RADIUS_PX;
  let isInside = isIn(pixel, sizePx);
  if (isInside) {
    if (isBroken(textureLoad(actual, pixel, 0))) { atomicAdd(&brokenActual, 1u); }
    if (isBroken(textureLoad(expected, pixel, 0))) { atomicAdd(&brokenExpected, 1u); }
  }

  /// Squared error, largest error, dissimilarity.
  var sums = vec3f();
  for (var channel = 0u; channel < 3u; channel++) {
    for (var i = lane; i < AREA_PIXELS; i += TILE_PIXELS) {
      let at = areaStart + vec2i(vec2u(i % AREA_PX, i / AREA_PX));
      var value = vec2f();
      if (isIn(at, sizePx)) {
        let a = shownValue(textureLoad(actual, at, 0), channel);
        let b = shownValue(textureLoad(expected, at, 0), channel);
        value = vec2f(a + b - 1.0, a - b);
      }
      area[i] = value;
    }
    workgroupBarrier();

    for (var i = lane; i < STRIP_PIXELS; i += TILE_PIXELS) {
      let column = i % COMPARE_TILE_PX;
      let first = (i / COMPARE_TILE_PX) * AREA_PX + column;
      var means = vec4f();
      for (var step = 0u; step < WINDOW_PX; step++) {
        let value = area[first + step];
        means += weight(step) * vec4f(value, value * value);
      }
      strip[i] = means / weightInside(areaStart.x + i32(column), sizePx.x);
    }
    workgroupBarrier();

    if (isInside) {
      var means = vec4f();
      for (var step = 0u; step < WINDOW_PX; step++) {
        means += weight(step) * strip[(place.y + step) * COMPARE_TILE_PX + place.x];
      }
      means /= weightInside(areaStart.y + i32(place.y), sizePx.y);
      let error = abs(area[(place.y + SSIM_RADIUS_PX) * AREA_PX + place.x + SSIM_RADIUS_PX].y);
      sums = vec3f(sums.x + error * error, max(sums.y, error), sums.z + dissimilarity(means));
      if (error > 0.0) { atomicAdd(&errorCounts[bitcast<u32>(error) >> ERROR_DROPPED_BITS], 1u); }
    }
    workgroupBarrier();
  }

  partials[lane] = sums;
  workgroupBarrier();
  for (var half = TILE_PIXELS / 2u; half > 0u; half >>= 1u) {
    if (lane < half) {
      let other = partials[lane + half];
      let own = partials[lane];
      partials[lane] = vec3f(own.x + other.x, max(own.y, other.y), own.z + other.z);
    }
    workgroupBarrier();
  }
  if (lane == 0u) {
    let total = partials[0];
    let tilesAcross = (u32(sizePx.x) + COMPARE_TILE_PX - 1u) / COMPARE_TILE_PX;
    tiles[workgroup.y * tilesAcross + workgroup.x] =
      CompareTile(total.x, total.y, total.z, atomicLoad(&brokenActual), atomicLoad(&brokenExpected));
  }
}

fn isIn(pixel: vec2i, sizePx: vec2i) -> bool {
  return all(pixel >= vec2i(0)) && all(pixel < sizePx);
}

/// Whether a value is infinite or NaN. Tests its bits: compilers may assume that there are none.
fn isBroken(value: vec4f) -> bool {
  return any((bitcast<vec4u>(value) & vec4u(0x7f800000u)) == vec4u(0x7f800000u));
}

fn shownValue(layer: vec4f, channel: u32) -> f32 {
  return clamp(layer[channel] + (1.0 - layer.a) * parameters.background[channel], 0.0, 1.0);
}

/// Weight of place `step` of a window.
fn weight(step: u32) -> f32 {
  let distancePx = f32(step) - f32(SSIM_RADIUS_PX);
  return exp(-distancePx * distancePx / (2.0 * SSIM_SIGMA_PX * SSIM_SIGMA_PX));
}

/// Sum of the weights of the part in 0…end of a window that starts at `start`.
fn weightInside(start: i32, end: i32) -> f32 {
  var sum = 0.0;
  for (var step = 0u; step < WINDOW_PX; step++) {
    let at = start + i32(step);
    if (at >= 0 && at < end) { sum += weight(step); }
  }
  return sum;
}

/// 1 − SSIM, from the means over a window of a + b − 1 and a − b, and of their squares.
fn dissimilarity(means: vec4f) -> f32 {
  let sum = means.x + 1.0;
  let difference = means.y;
  let varianceOfSum = max(0.0, means.z - means.x * means.x);
  let varianceOfDifference = max(0.0, means.w - difference * difference);
  // a² + b² = (s² + d²)/2, and so for the variances; 2ab = a² + b² − d².
  let luminance = difference * difference / (0.5 * (sum * sum + difference * difference) + SSIM_C1);
  let structure = varianceOfDifference / (0.5 * (varianceOfSum + varianceOfDifference) + SSIM_C2);
  return luminance + structure - luminance * structure;
}
