// Averages each square of SAMPLES_PER_SIDE² samples into a pixel. Reads samples, writes a texture;
// one thread per pixel. Values are premultiplied, so they can be averaged directly. Reference:
// measure.reference.ts.
import constants::IMAGE_TILE_PX;
import constants::SAMPLES_PER_SIDE;

@group(0) @binding(0) var samples: texture_2d<f32>;
@group(0) @binding(1) var image: texture_storage_2d<rgba32float, write>;

const SIDE_PX = IMAGE_TILE_PX;

@compute @workgroup_size(SIDE_PX, SIDE_PX)
fn averageSamples(@builtin(global_invocation_id) pixel: vec3u) {
  let first = SAMPLES_PER_SIDE * pixel.xy;
  var sum = vec4f();
  for (var y = 0u; y < SAMPLES_PER_SIDE; y++) {
    for (var x = 0u; x < SAMPLES_PER_SIDE; x++) {
      sum += textureLoad(samples, first + vec2u(x, y), 0);
    }
  }
  // Beyond the edge, writes do nothing.
  textureStore(image, pixel.xy, sum / f32(SAMPLES_PER_SIDE * SAMPLES_PER_SIDE));
}
