// Lets a cloud appear outward from a point: what is farther away than a radius is not there yet.
import package::lib::edge_fade::edgeFade;
import package::lib::packing::Splat;
import parameters::Reveal;

fn revealSplat(splat: Splat, splatIndex: u32, parameters: Reveal) -> Splat {
  let distanceWorld = length(parameters.linear * splat.position + parameters.offset);
  let shown = edgeFade(parameters.radius - distanceWorld, parameters.softEdge);
  var revealed = splat;
  revealed.opacity *= shown;
  // Nothing of a size of 0 is left to be drawn: its opacity is 0 as well.
  revealed.scale *= select(1.0, shown, parameters.grows == 1u);
  return revealed;
}
