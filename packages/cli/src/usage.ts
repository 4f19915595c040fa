import { SPLAT_FORMATS } from '@websplatter/core/formats';
import { DEFAULT_DETAILS } from './accuracy-options.ts';
import { OUT_FORMATS } from './convert-options.ts';

const listOf = (values: readonly string[]) => values.join(', ');

export const USAGE = `websplatter renders, inspects and converts Gaussian-splat scenes.

websplatter render SCENE … --out image.png [options]
  SCENE                  a file, a URL, - for standard input, or builtin:still-life, builtin:still-life-small; several are sorted
                         together
  --from NAME            the format of every SCENE that has neither a known signature nor a known name, such as a .splat
                         from standard input: ${listOf(SPLAT_FORMATS.map(({ name }) => name))}
  --camera auto          finds an upright camera that shows most of the sharp, unhidden splats, and prints it as JSON, to be saved;
                         a note says what is uncertain
  --camera CAM.json      {"position":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fovYDegrees":60,"near":0.01,"far":1000};
                         or "projection":"orthographic","height":h instead of the field of view;
                         or {"viewMatrix":[…],"projectionMatrix":[…]}, column-major (looking along -z, y up)
  --up auto              for --camera auto: finds which way is up by floors and walls; or x, y, z, -x, -y, -z if you know it
  --model M.json         a matrix per SCENE, in order: 16 numbers, column-major, or {"matrix":[…]}
  --size 1280x720        in pixels
  --out image.png        8-bit, opaque, over the background
  --raw image.f32        width × height × 4 float32, little-endian, premultiplied RGBA, top row first, no background
  --poster image.jpg     or .png: the same picture for <SplatCanvas poster>; prints the JSX of a <SplatCanvas> with this view
  --renderer gpu         or reference: float64 on the CPU, slow (all but precisions and formats apply)
  --accuracy balanced    or reference, high, fast, paper
  --set name=value       one accuracy setting; may be repeated
  --time 0.5             shows moving scenes at this time, in the unit of their file; by default at their first, mostly 0 of 0 to 1
  --sort-by auto         or depth, distance: what splats are sorted by; auto: distance if a scene's file asks for it, else depth
  --detail full          or limits, separated by commas: merged splats replace splats where light moves by less than
                         maxErrorPx=0.5 pixels, and until at most maxSplats=100000, or maxShare=0.5 of the splats in
                         sight, are drawn; or minPsnrDb=40: the fewest splats found that reach this PSNR; or, for bench,
                         maxFrameMs=8 or auto: as many splats as fit while the camera moves
  --background 0,0,0     r,g,b, each 0 to 1, in the image's sRGB space
  --frames 1             renders this many times; fails if two frames differ in any bit
  --timings t.json       writes milliseconds per stage, median and 99th percentile over the frames, and
                         which rasteriser drew them

websplatter info SCENE [--from NAME] [--json]
  format, version, writer and flags, counts, bounds, spherical harmonics per band, dropped splats by reason, bytes needed on the GPU

websplatter convert IN … OUT [options]
  writes scenes as a file of another format, given by the end of the file's name:
  ${listOf(OUT_FORMATS.map(({ extension }) => extension))}
  IN                     a SCENE; several become one only with --merge
  --from NAME            the format of every IN, as for render
  --format NAME          the format of OUT whatever its name: ${listOf(OUT_FORMATS.map(({ name }) => name))}
  --fps 30               frames per second of a .frames, whose frames are the scenes of a folder, by the numbers in their
                         names, or the IN in their order; frames whose rows correspond become differences, a tenth of
                         their size
  --merge                puts all of them into OUT, one after another; parts of a scene as .ply are rounded only once
  --time 0.5             freezes moving scenes at this time, without the splats that cannot be seen then; else they stay
                         moving, as .ply only; of a .frames, reads the frame at this second instead of the first
  --up AXIS              turns this axis, x, y, z, -x, -y or -z, to +y; --up=-y for most captures; or auto: finds which way
                         is up, prints it and its confidence, and turns it to +y; scenes of any size are then read once more
  --scale 1              then scales the scene by this factor
  --rotate 0,0,0         then turns the scene by these degrees about x, then y, then z
  --translate 0,0,0      then shifts the scene
  --crop a,b,c,d,e,f     then keeps the splats between a,b,c and d,e,f: minX,minY,minZ,maxX,maxY,maxZ; of a moving scene,
                         each by its place at its own time, or, with --time, by its place then
  --exposure 0           brightens by these stops, -10 to 10; written into the colours of splats, like the next three
  --saturation 1         0 makes colours grey, at most 4 makes them stronger
  --temperature 0        -1 is blue, 1 is orange
  --tint 0               -1 is green, 1 is magenta
  --sh 3                 keeps spherical harmonics up to this degree
  --temp FOLDER          where temporary files of .bricks lie, up to 208 bytes a splat; by default the folder of OUT
  --json                 prints splats, bytes and notes as JSON
  One scene of more than 256 MiB that becomes PLY or SPZ is read several times instead of held in memory. Scenes of
  any size, also from standard input and with --merge, become .bricks on the disk, by a thread for each core, at most 12.

websplatter split IN.bricks FOLDER
  cuts a file into pieces of 4 MiB, FOLDER/IN.bricks.000, .001 and so on, for servers that answer no range requests;
  open the scene by the URL or path of the first piece

websplatter accuracy SCENE … [options]
  measures each accuracy setting for this scene and view, and fewer splats: milliseconds, and error against the reference
  --from NAME            as for render
  --camera, --up, --size as for render
  --json                 prints everything that was measured, and a camera that was found, instead of the table
  --svg chart.svg        writes a chart of error over time, with the front marked
  --base balanced        the preset from which settings are changed, one at a time
  --sort-by auto         as for render
  --detail full          as for render: settings are compared at this detail, without --details
  --details ${DEFAULT_DETAILS}
                         percent of the splats to draw at most, each measured with the base's settings, against the full scene
                         and against that with 4x4 samples per pixel; or none
  --distance 1           multiplies the camera's distance from the scene
  --settings a,b         only these settings, e.g. alphaCutoff,colorTarget; default all
  --frames 15            measured frames per setting

websplatter bench SCENE|--synthetic N [options]
  measures frames on this GPU while the camera orbits: each stage and each pass, bytes that a pass must move against the
  rate at which the GPU copies, steadiness, visible splats, loading and memory
  --synthetic N          random splats instead of a SCENE: 10k to 16M
  --degree 3             degree of their spherical harmonics, 0 to 3
  --seed 1               seed of their random numbers
  --from NAME            as for render
  --camera, --up         as for render; synthetic scenes have a camera
  --size 1920x1080       in pixels
  --frames 100           measured frames
  --orbit 15             degrees that the camera covers in all of them, up to 360, with --camera in the middle
  --accuracy, --set, --detail
                         as for render
  --json                 prints everything that was measured, and a camera that was found, instead of tables

websplatter hardcases [--json | --markdown] [--filter text] [--size 64x64]
  renders scenes that break splat renderers and compares each with float64: worst stage error, dB per preset, verdict
  --filter text          only cases with this text in their name
  --size 64x64           a square, for cases that give no image size

websplatter soak [--frames 1000] [--seed 1] [--json]
  draws frames while cameras, clouds, sizes, settings and effects change at random and devices are lost; compares pictures with
  those of fresh engines, bit for bit, and counts the memory that remains
  --seed 1               seed of everything that changes at random

websplatter --help | --version

Files are written whole or not at all, links followed, modes and owners kept. Pipes and devices are written into. - is standard
output, as is /dev/stdout; messages then go to standard error. A file that a command reads is never written.

Exit status: 0 on success, 2 on bad input, 1 otherwise; errors are one line (WEBSPLATTER_DEBUG=1 adds the stack).
`;
