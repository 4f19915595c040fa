// Shows what is selected.
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
