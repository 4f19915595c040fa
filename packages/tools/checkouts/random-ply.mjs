const REST_VALUES = [0, 9, 24, 45];

/** Uniform numbers in [0, 1), the same for the same seed on every machine (mulberry32). */
function seededRandom(seed) {
  let state = seed | 0;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let bits = Math.imul(state ^ (state >>> 15), state | 1);
    bits ^= bits + Math.imul(bits ^ (bits >>> 7), bits | 61);
    return ((bits ^ (bits >>> 14)) >>> 0) / 2 ** 32;
  };
}

/**
 * A PLY file of splats at random in a cube about the origin, the same for the same options. A file, since its format outlasts
 * the types that splats have in memory.
 */
export function randomPly({
  count,
  seed = 1,
  shDegree = 3,
  halfExtent = 1,
  logScales = [-4.5, -2],
  opacityLogits = [-4, 4],
}) {
  const random = seededRandom(seed);
  const between = (min, max) => min + (max - min) * random();
  const restNames = Array.from({ length: REST_VALUES[shDegree] }, (_, i) => `f_rest_${i}`);
  const columns = [
    ...['x', 'y', 'z'].map((name) => [name, -halfExtent, halfExtent]),
    ...['f_dc_0', 'f_dc_1', 'f_dc_2'].map((name) => [name, -1.5, 1.5]),
    ...restNames.map((name) => [name, -0.3, 0.3]),
    ['opacity', ...opacityLogits],
    ...['scale_0', 'scale_1', 'scale_2'].map((name) => [name, ...logScales]),
    ...['rot_0', 'rot_1', 'rot_2', 'rot_3'].map((name) => [name, -1, 1]),
  ];
  const rows = new DataView(new ArrayBuffer(4 * columns.length * count));
  for (let i = 0; i < count; i++)
    for (const [column, [, min, max]] of columns.entries())
      rows.setFloat32(4 * (i * columns.length + column), between(min, max), true);
  const header = [
    'ply',
    'format binary_little_endian 1.0',
    `element vertex ${count}`,
    ...columns.map(([name]) => `property float ${name}`),
    'end_header\n',
  ].join('\n');
  return new Blob([header, rows.buffer]);
}
