// Effect `brightness`: scales a splat's light, as a longer or shorter exposure does. Runs per
// visible splat in project. Reads the colour and the factor; returns the colour. Scales linear
// light instead of the encoded values.
import package::lib::packing::Splat;
import package::lib::srgb::decodeSrgb;
import package::lib::srgb::encodeSrgb;
import parameters::Brightness;

fn exposeColor(
  color: vec3f,
  splat: Splat,
  splatIndex: u32,
  centerView: vec3f,
  parameters: Brightness,
) -> vec3f {
  return encodeSrgb(parameters.factor * decodeSrgb(color));
}
