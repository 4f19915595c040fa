// Reads records, which project writes, at each of their precisions. Used by keep-colors and pick, per visible splat, and by
// rasterize, per vertex.
import layout::SplatRecord;

/// Half axes at √2 standard deviations.
struct SplatAxes {
  majorUnit: vec2f,
  majorLengthPx: f32,
  minorUnit: vec2f,
  minorLengthPx: f32,
}

fn axesOf(splat: SplatRecord) -> SplatAxes {
  @if(RECORD_PAPER) let majorPx = unpack2x16float(splat.majorPx);
  @if(!RECORD_PAPER) let majorPx = splat.majorPx;
  let majorLengthPx = length(majorPx);
  let majorUnit = majorPx / majorLengthPx;
  @if(RECORD_PAPER) let minorPx = unpack2x16float(splat.minorPx);
  @if(RECORD_PAPER) let minorLengthPx = length(minorPx);
  @if(RECORD_PAPER) return SplatAxes(majorUnit, majorLengthPx, minorPx / minorLengthPx, minorLengthPx);
  @if(!RECORD_PAPER) return SplatAxes(majorUnit, majorLengthPx, vec2f(-majorUnit.y, majorUnit.x), splat.minorLengthPx);
}

/// Coordinate of a point `offset` px from the splat's centre, in units of its axes: the Gaussian is exp(−|local|²).
fn localCoordinate(axes: SplatAxes, offset: vec2f) -> vec2f {
  @if(!RECORD_PAPER) return vec2f(
    dot(offset, axes.majorUnit) / axes.majorLengthPx,
    dot(offset, axes.minorUnit) / axes.minorLengthPx,
  );
  // The axes are rounded independently, so they are not quite perpendicular.
  @if(RECORD_PAPER) let determinant = cross2(axes.majorUnit, axes.minorUnit);
  @if(RECORD_PAPER) return vec2f(
    cross2(offset, axes.minorUnit) / determinant / axes.majorLengthPx,
    cross2(axes.majorUnit, offset) / determinant / axes.minorLengthPx,
  );
}

@if(RECORD_PAPER)
fn cross2(a: vec2f, b: vec2f) -> f32 {
  return a.x * b.y - a.y * b.x;
}

fn opacityOf(splat: SplatRecord) -> f32 {
  @if(RECORD_F32) return splat.color.w;
  @if(RECORD_PAPER) return unpack4x8unorm(splat.color).w;
  @if(!RECORD_F32 && !RECORD_PAPER) return unpack2x16float(splat.color.y).y;
}

fn colorOf(splat: SplatRecord) -> vec3f {
  @if(RECORD_F32) return splat.color.rgb;
  @if(RECORD_PAPER) return unpack4x8unorm(splat.color).rgb;
  @if(!RECORD_F32 && !RECORD_PAPER) return vec3f(unpack2x16float(splat.color.x), unpack2x16float(splat.color.y).x);
}
