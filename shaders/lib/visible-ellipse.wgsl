// Computes where a splat lands in the image and how far it reaches. Shared by cull-splats, which
// decides whether the splat is drawn, project, which writes its record, and rasterize, which sizes
// its quad. Reference: packages/core/src/stages/cull/cull.reference.ts.
import layout::View;
import package::lib::covariance::ScreenCovariance;
@if(!ISOTROPIC) import package::lib::covariance::rotationMatrix;
import package::lib::covariance::screenCovariance;
import package::lib::packing::Splat;
@if(STACKED) import package::lib::stacked_opacity::cutoffGaussian;

struct ScreenSplat {
  centerPx: vec2f,
  depthView: f32,
  covariance: ScreenCovariance,
}

fn isInDepthRange(view: View, depthView: f32) -> bool {
  return depthView > view.near && depthView <= view.far;
}

/// Projects a splat in the depth range; `linear` takes cloud space to view space.
fn screenSplat(view: View, linear: mat3x3f, dilationPx2: f32, splat: Splat, centerView: vec3f) -> ScreenSplat {
  @if(!ISOTROPIC) let rotation = rotationMatrix(splat.rotation);
  @if(!ISOTROPIC) let axes = mat3x3f(rotation[0] * splat.scale.x, rotation[1] * splat.scale.y, rotation[2] * splat.scale.z);
  @if(!ISOTROPIC) let covariance = screenCovariance(view, dilationPx2, centerView, linear * axes);
  // Rotation does not change a ball.
  @if(ISOTROPIC) let covariance = screenCovariance(view, dilationPx2, centerView, linear * splat.scale.x);
  return ScreenSplat(screenCenter(view, centerView), -centerView.z, covariance);
}

/// Position in the image, px, of a point in the depth range.
fn screenCenter(view: View, centerView: vec3f) -> vec2f {
  @if(ORTHOGRAPHIC) let offset = view.focalPx * centerView.xy;
  @if(!ORTHOGRAPHIC) let offset = view.focalPx * centerView.xy / -centerView.z;
  return view.centerPx + vec2f(offset.x, -offset.y);
}

/// Distance, in units of the axes at √2 standard deviations, at which `opacity` has fallen to the
/// cutoff; with a fixed extent, the distance of an opaque splat or of a merged one.
fn reachInAxes(opacity: f32, alphaCutoff: f32) -> f32 {
  @if(STACKED) if (opacity > 1.0) { return sqrt(-log(cutoffGaussian(opacity, alphaCutoff))); }
  @if(FIXED_EXTENT) return sqrt(log(1.0 / alphaCutoff));
  // A splat whose opacity is rounded to less than the cutoff has reach 0; 0 has no logarithm.
  @if(!FIXED_EXTENT) return sqrt(log(max(1.0, opacity / alphaCutoff)));
}

/// Half extents, px, of the box around the visible part of the splat.
fn extentPx(covariance: ScreenCovariance, reach: f32) -> vec2f {
  return (reach * covariance.unitPx) * sqrt(2.0 * vec2f(covariance.a, covariance.c));
}
