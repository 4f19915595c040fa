// Gives more or less light, as a longer or shorter exposure does: linear light is scaled, not what encodes it.
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
