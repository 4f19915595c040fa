// Effect `reveal`: lets a cloud appear outward from a point. Runs per splat in cull-splats and
// project. Reads a splat, the point and the radius; returns the splat with the opacity, and
// optionally the size, that it has so far.
import package::lib::edge_fade::edgeFade;
import package::lib::packing::Splat;
import parameters::Reveal;

fn revealSplat(splat: Splat, splatIndex: u32, parameters: Reveal) -> Splat {
  let distanceWorld = length(parameters.linear * splat.position + parameters.offset);
  let shown = edgeFade(parameters.radius - distanceWorld, parameters.softEdge);
  var revealed = splat;
  revealed.opacity *= shown;
  // A splat of size 0 is never drawn: its opacity is 0 as well.
  revealed.scale *= select(1.0, shown, parameters.grows == 1u);
  return revealed;
}
