// View mode `overdraw`: gives all splats one colour and one opacity, so that pixels with more
// layers are fuller. Runs per splat in cull-splats and project.
import package::lib::packing::Splat;
import package::lib::visible_ellipse::ScreenSplat;
import parameters::Overdraw;

fn countedOpacity(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, parameters: Overdraw) -> f32 {
  return parameters.opacity;
}

fn countedColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: Overdraw) -> vec3f {
  return parameters.color;
}
