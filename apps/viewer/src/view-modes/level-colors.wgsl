// View mode `detail`: colours each splat by its level of detail. Runs per visible splat in project.
// Reads the level; returns a colour between those of the finest and of the coarsest one that is told
// apart, or that of what stands for detail that is missing.
import package::lib::packing::Splat;
import parameters::LevelColors;

/// Level of what stands for detail that is not on the GPU.
const MISSING_LEVEL = 15u;

fn levelColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, level: u32, parameters: LevelColors) -> vec3f {
  if (level == MISSING_LEVEL) { return parameters.missing; }
  return mix(parameters.low, parameters.high, min(f32(level) / parameters.coarsest, 1.0));
}
