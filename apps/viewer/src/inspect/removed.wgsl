// Effect `removed`: hides the selected splats. Runs per splat in cull-splats and project.
import package::lib::packing::Splat;

fn removeSplat(splat: Splat, splatIndex: u32, selected: bool) -> Splat {
  var left = splat;
  left.opacity = select(splat.opacity, 0.0, selected);
  return left;
}
