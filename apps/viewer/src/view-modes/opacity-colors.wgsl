// View mode `opacity`: colours each splat by its peak opacity. Runs per visible splat in project.
// Reads the splat; returns a mix of the colours for 0 and 1.
import package::lib::packing::Splat;
import parameters::OpacityColors;

fn opacityColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: OpacityColors) -> vec3f {
  return mix(parameters.low, parameters.high, splat.opacity);
}
