// Effect `relight`: lights a splat as a matt surface of its colour, by a normal from its shortest axis.
// Runs per visible splat in project. Reads the colour, the splat, its centre in view space and the list
// of lights; returns the colour. Reference: relight.reference.ts. lambert.wgsl and falloff.wgsl are
// joined to it.
//
// The list begins with
//
//   0…2   rows that map normals from the cloud's space to view space; number of lights, strength, and
//         1 for an orthographic camera, in this order
//   3     ambient irradiance, red, green and blue
//
// Four vec4f follow for each light, in view space:
//
//   0     direction to a directional light, place of a lamp, or the direction up; the kind of light
//   1     irradiance, of a lamp at a distance of 1; its decay
//   2     direction that a lamp shines along, or the irradiance from the ground; cutoff of a lamp
//   3     cosines of a lamp's cone and of its bright middle
import package::lib::covariance::rotationMatrix;
import package::lib::packing::Splat;
import package::lib::srgb::decodeSrgb;
import package::lib::srgb::encodeSrgb;
import parameters::relightAt;

fn relightColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f {
  let rows = array<vec4f, 3>(relightAt(0u), relightAt(1u), relightAt(2u));
  let surface = Surface(centerView, shadingNormal(splat, centerView, rows));
  var irradiance = relightAt(3u).xyz;
  for (var light = 0u; light < u32(rows[0].w); light++) {
    let at = 4u + 4u * light;
    irradiance += received(surface, relightAt(at), relightAt(at + 1u), relightAt(at + 2u), relightAt(at + 3u));
  }
  return relit(color, irradiance, rows[1].w);
}
