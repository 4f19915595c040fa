// View mode `detail`: colours each splat by its level of detail. Runs per visible splat in project.
// Reads the level; returns a mix of the colours for the finest and the coarsest level on the scale.
// Placeholders for detail that is not loaded have a colour of their own.
import package::lib::packing::Splat;
import parameters::LevelColors;

/// Level of placeholders for detail that is not on the GPU.
const MISSING_LEVEL = 15u;

fn levelColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, level: u32, parameters: LevelColors) -> vec3f {
  if (level == MISSING_LEVEL) { return parameters.missing; }
  return mix(parameters.low, parameters.high, min(f32(level) / parameters.coarsest, 1.0));
}
