import { coefficientsPerSplat, readCoefficients, type ShDegree, type SplatSet } from '@websplatter/core';
import { mergeSplats } from '@websplatter/core/write';
import { beforeAll, describe, expect, it } from 'vitest';
import { builtinScenes, stillLife, stillLifeCameras } from './index.ts';
import { evaluateShBasis, shBasisSize } from './sh-fit.ts';

const SMALL = 10_000;

/** FNV-1a over the columns' bytes. */
function hashOf(set: SplatSet): number {
  let hash = 0x811c9dc5;
  const columns = [
    set.positions,
    set.logScales,
    set.rotations,
    set.opacityLogits,
    set.colorDc,
    set.harmonics.coefficients,
    set.fileIndices,
  ];
  for (const column of columns) {
    for (const byte of new Uint8Array(column.buffer, column.byteOffset, column.byteLength)) {
      hash = Math.imul(hash ^ byte, 0x01000193);
    }
  }
  return hash >>> 0;
}

/** A splat's displayed colour seen along a unit direction camera → splat. */
function displayedColor(
  set: SplatSet,
  index: number,
  direction: readonly [number, number, number],
): number[] {
  const { degree } = set.harmonics;
  const basis = new Float64Array(shBasisSize(degree));
  evaluateShBasis(degree, ...direction, basis);
  const rest = new Float64Array(3 * (basis.length - 1));
  readCoefficients(set.harmonics, index, rest);
  return [0, 1, 2].map((channel) => {
    let color = 0.5 + basis[0] * set.colorDc[3 * index + channel];
    for (let j = 1; j < basis.length; j++) color += basis[j] * rest[3 * (j - 1) + channel];
    return Math.max(0, color);
  });
}

function opacities(set: SplatSet): Float64Array {
  return Float64Array.from(set.opacityLogits, (logit) => 1 / (1 + Math.exp(-logit)));
}

/** The splat's three standard deviations, largest first. */
function sortedScales(set: SplatSet, index: number): number[] {
  return [...set.logScales.subarray(3 * index, 3 * index + 3)].map(Math.exp).sort((a, b) => b - a);
}

function countWhere(set: SplatSet, holds: (index: number) => boolean): number {
  let count = 0;
  for (let index = 0; index < set.count; index++) if (holds(index)) count++;
  return count;
}

describe('stillLife', () => {
  let small: SplatSet;
  beforeAll(() => {
    small = stillLife({ splats: SMALL });
  });

  it('is the same for the same seed, and another for another', () => {
    const hash = hashOf(small);
    expect(hashOf(stillLife({ splats: SMALL }))).toBe(hash);
    expect(hashOf(stillLife({ splats: SMALL, seed: 2 }))).not.toBe(hash);
  });

  it('is made in shares too, whose splats one after another are the same', () => {
    const [scene] = builtinScenes.filter(({ splats }) => splats === SMALL);
    for (const of of [1, 3, 40]) {
      const shares = Array.from({ length: of }, (_, share) => scene.makeShare(share, of));
      expect(hashOf(mergeSplats(shares) as SplatSet)).toBe(hashOf(small));
    }
  });

  it.each([
    [-1, 2],
    [2, 2],
    [0.5, 2],
    [0, 0],
  ])('has no share %d of %d', (share, of) => {
    expect(() => builtinScenes[1].makeShare(share, of)).toThrow(`share is ${share} of ${of}`);
  });

  it.each([1_000, 1_237, 4_999, 20_011])('makes exactly %i splats, in consistent columns', (splats) => {
    const set = stillLife({ splats });
    expect(set.count).toBe(splats);
    expect(set.positions.length).toBe(3 * splats);
    expect(set.logScales.length).toBe(3 * splats);
    expect(set.rotations.length).toBe(4 * splats);
    expect(set.opacityLogits.length).toBe(splats);
    expect(set.colorDc.length).toBe(3 * splats);
    expect(set.harmonics.coefficients.length).toBe(splats * coefficientsPerSplat(3));
    expect(set.fileIndices[splats - 1]).toBe(splats - 1);
    expect(set.origin).toEqual([0, 0, 0]);
    expect(set.dropped).toEqual({});
  });

  it.each([999, 1_000_001, 1_500.5, Number.NaN])('refuses %d splats, naming the range', (splats) => {
    expect(() => stillLife({ splats })).toThrow(/1000 to 1000000/);
  });

  it.each([0, 1, 2, 3] as ShDegree[])('carries harmonics of degree %i when asked', (shDegree) => {
    const { harmonics } = stillLife({ splats: 1_000, shDegree });
    expect(harmonics).toMatchObject({ degree: shDegree, coefficients: expect.any(Float32Array) });
    expect(harmonics.coefficients.length).toBe(1_000 * coefficientsPerSplat(shDegree));
  });

  it('keeps metal bright without harmonics, by what it reflects on average', () => {
    const flat = stillLife({ splats: SMALL, shDegree: 0 });
    const meanOf = (set: SplatSet) => set.colorDc.reduce((sum, value) => sum + value, 0) / set.colorDc.length;
    expect(Math.abs(meanOf(flat) - meanOf(small))).toBeLessThan(0.15);
  });

  it('has only finite values', () => {
    const { positions, logScales, rotations, opacityLogits, colorDc, harmonics } = small;
    const rest = harmonics.coefficients;
    for (const column of [positions, logScales, rotations, opacityLogits, colorDc, rest]) {
      expect(column.every(Number.isFinite)).toBe(true);
    }
  });

  it('has unit rotations', () => {
    const lengths = Array.from({ length: SMALL }, (_, i) =>
      Math.hypot(...small.rotations.subarray(4 * i, 4 * i + 4)),
    );
    expect(Math.max(...lengths)).toBeLessThan(1.00001);
    expect(Math.min(...lengths)).toBeGreaterThan(0.99999);
  });

  it('has opacities as training leaves them: mostly high, with a tail of faint ones', () => {
    const all = opacities(small);
    expect(Math.min(...all)).toBeGreaterThan(0.005);
    expect(Math.max(...all)).toBeLessThan(0.999);
    expect(all.filter((opacity) => opacity > 0.7).length / SMALL).toBeGreaterThan(0.65);
    const faint = all.filter((opacity) => opacity < 0.3).length / SMALL;
    expect(faint).toBeGreaterThan(0.03);
    expect(faint).toBeLessThan(0.25);
  });

  it('spreads scales from threads to sky', () => {
    const largest = Array.from({ length: SMALL }, (_, i) => sortedScales(small, i)[0]);
    const smallest = Array.from({ length: SMALL }, (_, i) => sortedScales(small, i)[2]);
    expect(Math.min(...smallest)).toBeGreaterThan(1e-5);
    expect(Math.max(...largest)).toBeLessThan(30);
    expect(Math.max(...largest)).toBeGreaterThan(3);
  });

  it('has flat discs and long needles', () => {
    const discs = countWhere(small, (i) => {
      const [, middle, thin] = sortedScales(small, i);
      return middle / thin >= 4.9 && middle / thin <= 21;
    });
    const needles = countWhere(small, (i) => {
      const [long, middle] = sortedScales(small, i);
      return long / middle >= 8;
    });
    expect(discs / SMALL).toBeGreaterThan(0.55);
    expect(needles / SMALL).toBeGreaterThan(0.05);
    const sharpest = Math.max(
      ...Array.from({ length: SMALL }, (_, i) => {
        const [long, middle] = sortedScales(small, i);
        return long / middle;
      }),
    );
    expect(sharpest).toBeGreaterThan(12);
    expect(sharpest).toBeLessThan(301);
  });

  it('has energy in every band of the harmonics', () => {
    const rest = new Float64Array(45);
    const energy = [0, 0, 0];
    for (let i = 0; i < SMALL; i++) {
      readCoefficients(small.harmonics, i, rest);
      for (let value = 0; value < 45; value++) {
        energy[value < 9 ? 0 : value < 24 ? 1 : 2] += rest[value] ** 2;
      }
    }
    for (const band of energy) expect(Math.sqrt(band / SMALL)).toBeGreaterThan(0.02);
  });

  it("moves the steel ball's highlight with the camera", () => {
    const ball = { x: -0.02, y: 0.05, z: 0.17, radius: 0.05 };
    const onBall = (index: number, nx: number, ny: number, nz: number) => {
      const x = (small.positions[3 * index] - ball.x) / ball.radius;
      const y = (small.positions[3 * index + 1] - ball.y) / ball.radius;
      const z = (small.positions[3 * index + 2] - ball.z) / ball.radius;
      return Math.hypot(x - nx, y - ny, z - nz);
    };
    // Half-way between the light and a camera in front: the brightest place of the ball from there.
    let brightest = 0;
    for (let i = 1; i < SMALL; i++) {
      if (onBall(i, -0.41, 0.42, 0.81) < onBall(brightest, -0.41, 0.42, 0.81)) brightest = i;
    }
    const luminance = (direction: readonly [number, number, number]) => {
      const [red, green, blue] = displayedColor(small, brightest, direction);
      return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    };
    const fromFront = luminance([0, -0.25, -0.97]);
    const fromRight = luminance([-0.97, -0.25, 0]);
    expect(fromFront).toBeGreaterThan(0.8);
    expect(fromFront - fromRight).toBeGreaterThan(0.25);
  });

  it('never shines, from behind a surface, beyond a few times white', () => {
    const directions: [number, number, number][] = [
      [0, 1, 0],
      [0, -1, 0],
      [1, 0, 0],
      [-1, 0, 0],
      [0, 0, 1],
      [0, 0, -1],
    ];
    let brightest = 0;
    for (let i = 0; i < SMALL; i++) {
      for (const direction of directions)
        brightest = Math.max(brightest, ...displayedColor(small, i, direction));
    }
    expect(brightest).toBeLessThan(3);
  });
});

describe('builtinScenes', () => {
  it('states names once and counts rightly', () => {
    expect(new Set(builtinScenes.map((scene) => scene.name)).size).toBe(builtinScenes.length);
    const small = builtinScenes.find((scene) => scene.name === 'still-life-small');
    expect(small?.make().count).toBe(small?.splats);
    expect(builtinScenes.find((scene) => scene.name === 'still-life')?.splats).toBe(150_000);
  });
});

describe('stillLifeCameras', () => {
  it('have names of their own and see the whole scene, sky included', () => {
    expect(new Set(stillLifeCameras.map((camera) => camera.name)).size).toBe(stillLifeCameras.length);
    for (const camera of stillLifeCameras) {
      expect(camera.far).toBeGreaterThan(Math.hypot(...camera.position) + 150);
      expect(camera.near).toBeGreaterThan(0);
    }
  });
});
