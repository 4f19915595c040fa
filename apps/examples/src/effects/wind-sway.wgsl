// Lets what stands up sway in waves that run through the cloud. What is on the ground stays.
import package::lib::packing::Splat;
import parameters::WindSway;

fn swaySplat(splat: Splat, splatIndex: u32, parameters: WindSway) -> Splat {
  let height = dot(parameters.up, splat.position) + parameters.upOffset;
  let phase = dot(parameters.wave, splat.position) + parameters.phase;
  var swayed = splat;
  swayed.position += smoothstep(0.0, parameters.tall, height) * sin(phase) * parameters.push;
  return swayed;
}
