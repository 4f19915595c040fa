// View mode `ellipsoids`: every splat as a solid ellipse. Runs per splat in cull-splats and
// project. Reads a splat; returns it shrunk. Its peak opacity is so far above 1 that it is solid up
// to its edge and fades quickly beyond. Its colour is darkened by a hash of its index, so that
// neighbours can be told apart.
import package::lib::packing::Splat;
import package::lib::visible_ellipse::ScreenSplat;
import parameters::Ellipsoids;

/// 2³² times the fractional part of the golden ratio.
const GOLDEN = 2654435769u;

fn shrinkEllipsoid(splat: Splat, splatIndex: u32, parameters: Ellipsoids) -> Splat {
  var shrunk = splat;
  shrunk.scale *= parameters.shrinking;
  return shrunk;
}

fn solidOpacity(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, parameters: Ellipsoids) -> f32 {
  return parameters.peakOpacity;
}

fn shadeEllipsoid(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: Ellipsoids) -> vec3f {
  // Successive multiples of the golden ratio lie far apart, and successive splats are often
  // neighbours.
  let part = f32((splatIndex * GOLDEN) >> 8u) / 16777216.0;
  return color * mix(parameters.darkest, 1.0, part);
}
