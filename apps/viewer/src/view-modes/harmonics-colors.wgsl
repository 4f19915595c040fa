// View mode `harmonics`: colours each splat by how far its harmonics above degree 0 change its
// colour. Runs per visible splat in project. Reads the colour as seen from the camera and the
// coefficients of degree 0; returns a mix of the colours for no change and for the largest change
// on the scale.
import package::lib::packing::Splat;
import parameters::HarmonicsColors;

/// √(1/4π): the harmonic of degree 0.
const DEGREE_0 = 0.28209479177387814;

fn harmonicsColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: HarmonicsColors) -> vec3f {
  let base = max(vec3f(0.0), 0.5 + DEGREE_0 * splat.colorDc);
  let change = abs(max(color, vec3f(0.0)) - base);
  let largest = max(change.r, max(change.g, change.b));
  return mix(parameters.low, parameters.high, min(largest / parameters.most, 1.0));
}
