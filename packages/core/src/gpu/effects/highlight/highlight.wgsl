// Effect `highlight`: tints the selected splats. Runs per visible splat in project.
// Reads the colour and whether the splat is selected; returns the colour.
import package::lib::packing::Splat;
import parameters::Highlight;

fn highlightColor(
  color: vec3f,
  splat: Splat,
  splatIndex: u32,
  centerView: vec3f,
  selected: bool,
  parameters: Highlight,
) -> vec3f {
  return select(color, mix(color, parameters.color, parameters.strength), selected);
}
