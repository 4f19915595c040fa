// Effect `opacity`: makes a whole cloud fainter. Runs per splat in cull-splats and project.
// Reads a splat and the factor; returns the splat with its opacity scaled.
// Runs before anything is computed from the splat: a fading splat shrinks, and is finally culled.
import package::lib::packing::Splat;
import parameters::Opacity;

fn fadeSplat(splat: Splat, splatIndex: u32, parameters: Opacity) -> Splat {
  var faded = splat;
  faded.opacity *= parameters.factor;
  return faded;
}
