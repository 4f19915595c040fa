// Makes a whole cloud fainter. Before anything is made of a splat: what fades away shrinks, and is then left out.
import package::lib::packing::Splat;
import parameters::Opacity;

fn fadeSplat(splat: Splat, splatIndex: u32, parameters: Opacity) -> Splat {
  var faded = splat;
  faded.opacity *= parameters.factor;
  return faded;
}
