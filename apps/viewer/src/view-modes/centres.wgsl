// View mode `centres`: a round dot of the same size for every splat. Runs per splat in cull-splats
// and project. Reads a splat; returns it with zero extent, so that dilation alone gives it a size.
// Its peak opacity turns the Gaussian into a dot: half transparent at the edge, almost opaque
// inside.
import package::lib::packing::Splat;
import package::lib::visible_ellipse::ScreenSplat;
import parameters::Centres;

fn shrinkToCentre(splat: Splat, splatIndex: u32, parameters: Centres) -> Splat {
  var shrunk = splat;
  shrunk.scale = vec3f(0.0);
  return shrunk;
}

fn dotOpacity(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, parameters: Centres) -> f32 {
  return 0.5 * exp(0.5 * parameters.radiusPx * parameters.radiusPx / dilationPx2);
}
