// Sways splats in waves that run through the cloud. Splats on the ground stay.
import package::lib::packing::Splat;
import parameters::WindSway;

fn swaySplat(splat: Splat, splatIndex: u32, parameters: WindSway) -> Splat {
  let height = dot(parameters.up, splat.position) + parameters.upOffset;
  let phase = dot(parameters.wave, splat.position) + parameters.phase;
  var swayed = splat;
  swayed.position += smoothstep(0.0, parameters.tall, height) * sin(phase) * parameters.push;
  return swayed;
}
