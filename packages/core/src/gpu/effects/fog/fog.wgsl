// Effect `fog`: mixes a splat's colour with the fog's, more of it with distance. Runs per visible
// splat in project. Reads the colour and the centre's view depth; returns the colour. Mixes in
// linear light, as fog on meshes does.
import package::lib::edge_fade::edgeFade;
import package::lib::packing::Splat;
import package::lib::srgb::decodeSrgb;
import package::lib::srgb::encodeSrgb;
import parameters::Fog;

fn fogColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: Fog) -> vec3f {
  let depthView = -centerView.z;
  var hidden = edgeFade(depthView - parameters.near, parameters.range);
  if (parameters.density > 0.0) {
    // At 16 nothing shines through, as e^−16² is 0 in float32; the square of a larger thickness could overflow.
    let thickness = min(parameters.density * abs(depthView), 16.0);
    hidden = 1.0 - exp(-thickness * thickness);
  }
  // No light is left of a colour below 0.
  let light = decodeSrgb(max(color, vec3f(0.0)));
  return encodeSrgb(mix(light, decodeSrgb(parameters.color), hidden));
}
