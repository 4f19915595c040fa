import type { SplatSet } from '@websplatter/core';

/** Splats that are as large as they are described; more are smaller. */
const COUNT = 400;
/** Of more splats, nine in ten are too faint to be drawn: SwiftShader takes seconds for all. */
const MOST_DRAWN = 10_000;

/**
 * Makes a small cloud of colourful splats that looks different from every side: on one side there
 * are many more of them, larger and redder. Deterministic; off the origin, so that turning about
 * the wrong point shows.
 */
export function testScene(count = COUNT): SplatSet {
  const random = randomNumbers(7);
  const size = Math.cbrt(COUNT / count);
  const positions = new Float32Array(3 * count);
  const logScales = new Float32Array(3 * count);
  const rotations = new Float32Array(4 * count);
  const opacityLogits = new Float32Array(count);
  const colorDc = new Float32Array(3 * count);
  const coefficients = new Float32Array(9 * count);
  for (let i = 0; i < count; i++) {
    const along = random() ** 2;
    positions.set([4 * along - 1, 1 + along * (random() - 0.5) * 2, random() * 2 - 1], 3 * i);
    for (let axis = 0; axis < 3; axis++)
      logScales[3 * i + axis] = Math.log(size * (0.02 + 0.2 * random() * (0.3 + along)));
    for (let axis = 0; axis < 4; axis++) rotations[4 * i + axis] = random() - 0.5;
    const opacityLogit = 6 * random() - 2;
    opacityLogits[i] = count <= MOST_DRAWN || i % 10 === 0 ? opacityLogit : -8;
    colorDc.set([2.5 * along - 0.5, 2 * random() - 1, 1.5 - 2.5 * along], 3 * i);
    for (let k = 0; k < 9; k++) coefficients[9 * i + k] = 0.4 * (random() - 0.5);
  }
  const fileIndices = Uint32Array.from({ length: count }, (_, i) => i);
  return {
    count,
    origin: [0, 0, 0],
    positions,
    logScales,
    rotations,
    opacityLogits,
    colorDc,
    harmonics: { degree: 1, coefficients },
    fileIndices,
    dropped: {},
  };
}

/** Uniform numbers in 0…1 (mulberry32). */
function randomNumbers(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** A scene whose file is large enough to be shown while it arrives. */
export function slowScene(): SplatSet {
  return testScene(80_000);
}
