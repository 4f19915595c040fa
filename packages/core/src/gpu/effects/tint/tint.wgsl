// Effect `tint`: colours a cloud, as a filter in front of it does. Runs per visible splat in
// project. Reads the colour and the filter's; returns their product.
import package::lib::packing::Splat;
import parameters::Tint;

fn tintColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: Tint) -> vec3f {
  return color * parameters.color;
}
