// Effect `grade`: maps colours by a matrix. Runs per visible splat in project. Reads the encoded
// colour and the rows of the matrix; returns their products.
import package::lib::packing::Splat;
import parameters::Grade;

fn gradeColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, parameters: Grade) -> vec3f {
  return vec3f(dot(parameters.red, color), dot(parameters.green, color), dot(parameters.blue, color));
}
