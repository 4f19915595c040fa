export const USAGE = `websplatter renders and inspects Gaussian-splat scenes.

websplatter render SCENE … --camera CAM.json --size WIDTHxHEIGHT --out image.png [options]
  SCENE                  a file, a URL, or builtin:still-life, builtin:still-life-small; several are sorted together
  --camera CAM.json      {"position":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fovYDegrees":60,"near":0.01,"far":1000};
                         or "projection":"orthographic","height":h instead of the field of view;
                         or {"viewMatrix":[…],"projectionMatrix":[…]}, column-major (looking along -z, y up)
  --model M.json         a matrix per SCENE, in order: 16 numbers, column-major, or {"matrix":[…]}
  --size 256x256         in pixels
  --out image.png        8-bit opaque, over the background
  --raw image.f32        width × height × 4 float32, little-endian, premultiplied RGBA, top row first, no background
  --renderer gpu         or reference: float64 on the CPU, slow (all but precisions and formats apply)
  --accuracy balanced    or reference, high, fast, paper
  --set name=value       one accuracy setting; may be repeated
  --background 0,0,0     r,g,b, each 0 to 1, in the picture's sRGB space
  --frames 1             renders as many times; fails where two frames differ in a bit
  --timings t.json       writes milliseconds per stage, median and 99th percentile over the frames

websplatter info SCENE [--json]
  counts, bounds, spherical harmonics per band, left-out splats by reason, bytes needed on the GPU

websplatter accuracy SCENE … --camera CAM.json --size WIDTHxHEIGHT [options]
  what each accuracy setting costs in milliseconds and in error against the reference, for this scene and view
  --json                 everything that was measured, instead of the table
  --svg chart.svg        writes a chart: error over time, the front marked
  --base balanced        the preset that settings are changed from, one at a time
  --settings a,b         only these settings, e.g. shDegree,colorTarget; default all
  --frames 15            measured frames per setting

websplatter hardcases [--json | --markdown] [--filter text] [--size 64x64]
  scenes that break splat renderers, each held against float64: worst error of a stage, decibels per preset, verdict
  --filter text          only cases with that in their name
  --size 64x64           of pictures of which the case gives no size; a square

websplatter --help | --version

Exit status: 0 on success, 2 on bad input, 1 otherwise; errors are one line (WEBSPLATTER_DEBUG=1 adds the stack).
`;
