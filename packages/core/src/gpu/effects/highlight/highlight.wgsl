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
  // A colour below 0 is drawn as 0.
  let seen = max(color, vec3f(0.0));
  return select(color, mix(seen, parameters.color, parameters.strength), selected);
}
