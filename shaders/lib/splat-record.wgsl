// Reads records, which project writes, at each of their precisions, and defines the opacity of a
// splat at a pixel.
import constants::MAX_FRAGMENT_ALPHA;
import layout::SplatRecord;
@if(STACKED) import package::lib::stacked_opacity::stackedAlpha;

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

/// √log₂e: from units where the Gaussian is exp(−|p|²) to 2^(−|p|²), which GPUs compute at once.
const TO_HALVINGS = 1.2011224087864498;

/// Gradients of a splat's local coordinates, 1/px, as rows: there the Gaussian is 2^(−|local|²).
fn localGradients(splat: SplatRecord) -> vec4f {
  @if(!RECORD_PAPER) let majorPx = splat.majorPx;
  @if(!RECORD_PAPER) let length2 = dot(majorPx, majorPx);
  @if(!RECORD_PAPER) let minor = TO_HALVINGS * inverseSqrt(length2) / splat.minorLengthPx;
  @if(!RECORD_PAPER) return vec4f(majorPx * (TO_HALVINGS / length2), -majorPx.y * minor, majorPx.x * minor);
  // The axes are rounded independently, so they are not quite perpendicular.
  @if(RECORD_PAPER) let axes = axesOf(splat);
  @if(RECORD_PAPER) let factor = TO_HALVINGS / cross2(axes.majorUnit, axes.minorUnit);
  @if(RECORD_PAPER) return vec4f(
    vec2f(axes.minorUnit.y, -axes.minorUnit.x) * (factor / axes.majorLengthPx),
    vec2f(-axes.majorUnit.y, axes.majorUnit.x) * (factor / axes.minorLengthPx),
  );
}

/// Local coordinates of a point `offset` px from the splat's centre.
fn localCoordinate(gradients: vec4f, offset: vec2f) -> vec2f {
  return offset.x * gradients.xz + offset.y * gradients.yw;
}

/// Gradients, 1/px, of other local coordinates, of which one depends on the column alone: at an offset
/// (dx, dy) px the Gaussian is 2^(−u² − v²), where u = x·dx + y·dy and v = z·dx. The axes need not be
/// perpendicular, and however thin the splat is, nothing that matters cancels.
fn columnGradients(splat: SplatRecord) -> vec3f {
  @if(RECORD_PAPER) let major = unpack2x16float(splat.majorPx);
  @if(RECORD_PAPER) let minor = unpack2x16float(splat.minorPx);
  @if(RECORD_PAPER) let area = abs(cross2(major, minor));
  @if(!RECORD_PAPER) let major = splat.majorPx;
  @if(!RECORD_PAPER) let length2 = dot(major, major);
  @if(!RECORD_PAPER) let ratio = splat.minorLengthPx * inverseSqrt(length2);
  @if(!RECORD_PAPER) let minor = vec2f(-major.y, major.x) * ratio;
  @if(!RECORD_PAPER) let area = length2 * ratio;
  let width2 = major.x * major.x + minor.x * minor.x;
  let skew = major.x * major.y + minor.x * minor.y;
  return TO_HALVINGS * inverseSqrt(width2) * vec3f(-skew / area, width2 / area, 1.0);
}

/// Opacity of a splat at a pixel with these local coordinates; 0 below the cutoff.
fn fragmentAlpha(opacity: f32, local: vec2f, alphaCutoff: f32) -> f32 {
  @if(!STACKED) return drawnAlpha(opacity * exp2(-dot(local, local)), alphaCutoff);
  @if(STACKED) return drawnAlpha(stackedAlpha(opacity, exp2(-dot(local, local))), alphaCutoff);
}

/// Alpha as it is drawn: capped, and 0 below the cutoff.
fn drawnAlpha(alpha: f32, alphaCutoff: f32) -> f32 {
  let capped = min(MAX_FRAGMENT_ALPHA, alpha);
  return select(0.0, capped, capped >= alphaCutoff);
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
