// View mode `depth`: colours each splat by 1/depth of its centre. Runs per visible splat in
// project. Reads the centre; returns a mix of the near and the far colour.
import package::lib::packing::Splat;
import parameters::DepthColors;

fn depthColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: DepthColors) -> vec3f {
  // 0 at the far end, 1 at the near end or nearer, also behind the camera.
  let nearness = (parameters.near / max(-centerView.z, parameters.near) - parameters.farNearness) / (1.0 - parameters.farNearness);
  return mix(parameters.farColor, parameters.nearColor, max(nearness, 0.0));
}
