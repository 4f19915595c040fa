/** Everything around the table: terrace, meadow, hills with cypresses, sky, and haze between them. */
import { FOOTPRINTS, GROUND_Y } from './arrangement.ts';
import { emitFibres } from './fibres.ts';
import { KEY_DIRECTION, KEY_RADIANCE, keyDisc, type Rgb, skyRadiance } from './lighting.ts';
import {
  type Cell,
  cellularNoise,
  clamp01,
  fractalNoise,
  latticeHash,
  mix,
  smoothstep,
  valueNoise,
} from './noise.ts';
import { type Part, type Studio, surfacePart, writeFrame } from './part.ts';
import { fibonacciDirections } from './sh-fit.ts';
import type { Finish } from './shading.ts';
import { GOLDEN_RATIO_CONJUGATE, type Surface, type SurfacePoint } from './surface-sampling.ts';

/** The paved terrace ends here, metres from the table's middle. */
const TERRACE_RADIUS = 3.4;
/** Behind the crest of the nearest hills. */
const MEADOW_RADIUS = 48;
/** Below this radius the ground's splats stop getting smaller. */
const GROUND_CORE_RADIUS = 1.3;

/** How fast splats thin out with distance: splats beyond a radius go as its power -0.5, so sizes as its power 1.25. */
const GROUND_THINNING = 0.5;

/** Ground whose splats grow a little faster than their distance from the table: sharp paving, soft meadow. */
class GroundSurface implements Surface {
  readonly area = Math.PI * MEADOW_RADIUS ** 2;
  readonly #within = 1 - (1 + MEADOW_RADIUS / GROUND_CORE_RADIUS) ** -GROUND_THINNING;

  sample(u: number, v: number, point: SurfacePoint): number {
    const stretch = (1 - u * this.#within) ** (-1 / GROUND_THINNING);
    const radius = GROUND_CORE_RADIUS * (stretch - 1);
    point.x = radius * Math.cos(2 * Math.PI * v);
    point.z = radius * Math.sin(2 * Math.PI * v);
    // Beyond the terrace the meadow rolls gently.
    const roll = smoothstep(TERRACE_RADIUS, 14, radius);
    point.y = GROUND_Y + roll * (0.5 * valueNoise(point.x * 0.12, 7, point.z * 0.12) - 0.15);
    point.normalX = 0;
    point.normalY = 1;
    point.normalZ = 0;
    point.localX = point.x;
    point.localY = 0;
    point.localZ = point.z;
    const radiusPerU =
      (this.#within / GROUND_THINNING) * GROUND_CORE_RADIUS * stretch ** (1 + GROUND_THINNING);
    return 2 * Math.PI * radius * radiusPerU;
  }
}

const FLAGSTONE_M = 0.52;
const FLAGSTONE_WARM: Rgb = [0.36, 0.285, 0.2];
const FLAGSTONE_COOL: Rgb = [0.24, 0.22, 0.19];
const JOINT: Rgb = [0.1, 0.095, 0.05];
const GRASS: Rgb = [0.13, 0.15, 0.035];
const GRASS_DRY: Rgb = [0.3, 0.235, 0.075];

const cell: Cell = { border: 0, id: 0 };

function groundFinish({ x, z, spacing }: SurfacePoint, finish: Finish): void {
  const radius = Math.hypot(x, z) + 0.5 * valueNoise(x * 1.3, 4, z * 1.3);
  cellularNoise(x / FLAGSTONE_M, z / FLAGSTONE_M, cell);
  const grit = fractalNoise(x * 14, 3, z * 14, 2);
  finish.mixAlbedo(FLAGSTONE_WARM, FLAGSTONE_COOL, clamp01(cell.id + 0.5 * grit));
  finish.scaleAlbedo(0.8 + 0.35 * latticeHash(Math.floor(cell.id * 1e6), 1, 1) + 0.2 * grit);
  // Joints fade where splats are too coarse to draw them.
  const jointWidth = 0.035 + (0.25 * spacing) / FLAGSTONE_M;
  const joint = 1 - smoothstep(0.4 * jointWidth, jointWidth, cell.border);
  finish.blendAlbedo(JOINT, 0.85 * joint * clamp01(0.3 / (spacing / FLAGSTONE_M + 0.1)));
  const meadow = smoothstep(TERRACE_RADIUS - 0.15, TERRACE_RADIUS + 0.25, radius);
  const dry = clamp01(0.5 + fractalNoise(x * 0.35, 9, z * 0.35, 3) + 0.35 * valueNoise(x * 2.5, 8, z * 2.5));
  for (let k = 0; k < 3; k++) {
    finish.albedo[k] = mix(finish.albedo[k], mix(GRASS[k], GRASS_DRY[k], dry), meadow);
  }
  hazeAlbedo(finish, radius);
  finish.cavity = 1 - 0.35 * joint * (1 - meadow);
  finish.opacityLow = 0.9;
}

/** Distance over which air takes about two thirds of a colour. */
const HAZE_DISTANCE_M = 210;
/** Radiance that the air adds at the horizon, linear. */
const HAZE_COLOR: Rgb = [0.66, 0.66, 0.68];

/** The same towards the sun, which lights the air from behind. */
const HAZE_SUNLIT: Rgb = [1.15, 0.88, 0.62];

/** Colour of the air in a horizontal direction. */
function hazeColor(cos: number, sin: number, channel: number): number {
  const towardsKey = clamp01(0.5 + 0.6 * (cos * KEY_DIRECTION[0] + sin * KEY_DIRECTION[2]));
  return mix(HAZE_COLOR[channel], HAZE_SUNLIT[channel], towardsKey * towardsKey);
}

function hazeShare(distance: number): number {
  return 1 - Math.exp(-distance / HAZE_DISTANCE_M);
}

/** Air in front of far ground, as albedo: sun and sky give a white surface about 2 at this height of the sun. */
function hazeAlbedo(finish: Finish, distance: number): void {
  const share = hazeShare(distance);
  for (let k = 0; k < 3; k++) {
    finish.albedo[k] = mix(finish.albedo[k], HAZE_COLOR[k] / (0.6 * KEY_RADIANCE[k] + 0.5), share);
  }
}

interface Ridge {
  readonly radius: number;
  readonly height: number;
  readonly roughness: number;
  readonly seed: number;
}

const RIDGES: readonly Ridge[] = [
  { radius: 38, height: 3.2, roughness: 2.4, seed: 11 },
  { radius: 56, height: 7.5, roughness: 4.5, seed: 23 },
  { radius: 76, height: 14, roughness: 7, seed: 37 },
];
/** How far a hill's crest lies behind its foot. */
const RIDGE_DEPTH_M = 9;

function ridgeHeight(ridge: Ridge, angle: number): number {
  const x = Math.cos(angle);
  const z = Math.sin(angle);
  const broad = fractalNoise(x * 1.7 + ridge.seed, ridge.seed, z * 1.7, 3);
  return Math.max(0.6, ridge.height + ridge.roughness * 1.4 * broad);
}

const FIELD_COLORS: readonly Rgb[] = [
  [0.16, 0.17, 0.05],
  [0.34, 0.26, 0.09],
  [0.1, 0.13, 0.045],
  [0.42, 0.33, 0.14],
];
const WOODLAND: Rgb = [0.045, 0.065, 0.03];

/** Lit colour of a hill: fields, woods in the folds, sun by slope, and the air before it. */
function emitRidge(ridge: Ridge, count: number, { builder, shader, prng }: Studio): void {
  const frame = new Float64Array(9);
  const scales = new Float64Array(3);
  const patch: Cell = { border: 0, id: 0 };
  const angleStep = 0.01;
  for (let i = 0; i < count; i++) {
    const rise = (i + 0.5) / count;
    const angle = 2 * Math.PI * ((i * GOLDEN_RATIO_CONJUGATE) % 1);
    const height = ridgeHeight(ridge, angle);
    const slopeAlong = (ridgeHeight(ridge, angle + angleStep) - height) / (angleStep * ridge.radius);
    const steep = Math.hypot(height + 1, RIDGE_DEPTH_M);
    const radius = ridge.radius + RIDGE_DEPTH_M * rise;
    const cos = Math.cos(angle);
    const sin = Math.sin(angle);
    const x = radius * cos;
    const y = GROUND_Y - 1 + (height + 1) * Math.sin(rise * 1.35) * 1.02;
    const z = radius * sin;
    // Tangents: up the slope, and along the ridge.
    const inwards = (height + 1) / steep;
    const upwards = RIDGE_DEPTH_M / steep;
    const nx = -cos * inwards + sin * slopeAlong * upwards;
    const nz = -sin * inwards - cos * slopeAlong * upwards;
    const length = Math.hypot(nx, upwards, nz);
    writeFrame(-sin, 0, cos, -cos * inwards, upwards, -sin * inwards, frame);
    const facing = (nx * KEY_DIRECTION[0] + upwards * KEY_DIRECTION[1] + nz * KEY_DIRECTION[2]) / length;
    cellularNoise(angle * ridge.radius * 0.16 + ridge.seed, rise * 3.2, patch);
    const field = FIELD_COLORS[Math.floor(patch.id * FIELD_COLORS.length)];
    const woods = smoothstep(0.02, 0.3, fractalNoise(x * 0.1, ridge.seed, z * 0.1, 3));
    const share = hazeShare(radius * 1.25);
    const tone = 1 + 0.12 * prng.gaussian();
    const color = [0, 0, 0];
    for (let k = 0; k < 3; k++) {
      const albedo = mix(
        field[k],
        WOODLAND[k],
        Math.max(woods, 0.5 * (1 - smoothstep(0, 0.08, patch.border))),
      );
      const lit = albedo * (KEY_RADIANCE[k] * Math.max(0.08, facing) + 0.55);
      color[k] = mix(lit * tone, hazeColor(cos, sin, k), share);
    }
    shader.setFlat(color[0], color[1], color[2]);
    const spacing = Math.sqrt((2 * Math.PI * radius * steep) / count);
    const stretch = Math.exp(0.2 * prng.gaussian());
    scales[0] = 0.75 * spacing * 1.25 * stretch;
    // Near the crest splats get lower, so that the outline against the sky stays crisp.
    scales[1] = ((0.75 * spacing) / 1.25 / stretch) * mix(1, 0.5, smoothstep(0.75, 1, rise));
    scales[2] = 0.12 * spacing;
    builder.add(x, y, z, frame, scales, prng.range(0.9, 0.99), shader.coefficients);
  }
}

const TREES = 70;
/** Splats of a tree in the full scene; larger scenes make finer trees, smaller ones fewer. */
const TREE_SPLATS = 30;
const GROVE_TREES = 5;
const CYPRESS: Rgb = [0.028, 0.042, 0.02];

/** Cypresses in groves of five, each a handful of upright ellipsoids. */
function emitTrees(count: number, { builder, shader, prng }: Studio): void {
  const frame = new Float64Array(9);
  const scales = new Float64Array(3);
  const treeSplats = Math.max(TREE_SPLATS, Math.ceil(count / TREES));
  const finer = Math.cbrt(TREE_SPLATS / treeSplats);
  for (let i = 0; i < count; i++) {
    const tree = Math.floor(i / treeSplats);
    const inGrove = tree % GROVE_TREES;
    const grove = Math.floor(tree / GROVE_TREES);
    const angle =
      2 * Math.PI * ((grove * GOLDEN_RATIO_CONJUGATE + 0.67) % 1) + 0.11 * inGrove * latticeHash(grove, 2, 9);
    const distance = mix(17, 36, latticeHash(grove, 3, 9)) + 1.3 * latticeHash(tree, 4, 9);
    const height = mix(2.2, 4.6, latticeHash(tree, 5, 9));
    const width = height * mix(0.1, 0.15, latticeHash(tree, 6, 9));
    const rise = ((i % treeSplats) + 0.5) / treeSplats;
    const outline = Math.sin(Math.PI * rise ** 0.6) ** 0.7;
    const turn = 2 * Math.PI * prng.next();
    const aside = width * outline * 0.6 * Math.sqrt(prng.next());
    const x = distance * Math.cos(angle) + aside * Math.cos(turn);
    const y = GROUND_Y - 0.3 + height * rise;
    const z = distance * Math.sin(angle) + aside * Math.sin(turn);
    const facing = Math.cos(turn) * KEY_DIRECTION[0] + Math.sin(turn) * KEY_DIRECTION[2];
    const sun = Math.max(0.1, 0.3 + facing + 0.5 * rise);
    const share = hazeShare(distance * 0.9);
    const tone = 0.75 + 0.5 * prng.next();
    const [red, green, blue] = CYPRESS.map((albedo, k) =>
      mix(
        albedo * tone * (KEY_RADIANCE[k] * sun + 0.7),
        hazeColor(Math.cos(angle), Math.sin(angle), k),
        share,
      ),
    );
    shader.setFlat(red, green, blue);
    writeFrame(0, 1, 0, Math.cos(turn), 0, Math.sin(turn), frame);
    const size = 0.1 * finer * height * (0.4 + 0.6 * outline) * Math.exp(0.15 * prng.gaussian());
    scales[0] = 1.1 * size;
    scales[1] = 0.5 * size;
    scales[2] = 0.35 * size;
    builder.add(x, y, z, frame, scales, prng.range(0.75, 0.97), shader.coefficients);
  }
}

const SKY_RADIUS_M = 110;
/** The dome reaches a little below the horizon, behind the hills. */
const SKY_LOWEST = -0.06;
/** Standard deviation of a sky splat over its spacing: wider than elsewhere, for a sky without grain. */
const SKY_COVERAGE = 0.95;
/** Share of the sun disc's brightness that thin cloud lets through. */
const SUN_DIMMING = 0.05;

function emitSky(count: number, { builder, shader, prng }: Studio): void {
  const directions = fibonacciDirections(count, SKY_LOWEST);
  const spacing = SKY_RADIUS_M * Math.sqrt((2 * Math.PI * (1 - SKY_LOWEST)) / count);
  const frame = new Float64Array(9);
  const scales = new Float64Array(3);
  const radiance = new Float64Array(3);
  for (let i = 0; i < count; i++) {
    const dx = directions[3 * i];
    const dy = directions[3 * i + 2];
    const dz = directions[3 * i + 1];
    // Looking up at the zenith brightness must not come from the ground's blend below the horizon.
    skyRadiance(dx, Math.max(dy, 0.04), dz, 0, radiance);
    const sun = SUN_DIMMING * keyDisc(dx, dy, dz, 0.75);
    // Clouds on a flat layer: they crowd towards the horizon.
    const layer = 1 / (Math.max(dy, 0) + 0.22);
    const cover = fractalNoise(dx * layer * 1.1 + 3, 2, dz * layer * 2.1, 4);
    const cloud = 0.75 * smoothstep(0.0, 0.42, cover) * smoothstep(0.02, 0.2, dy) * (1 - 0.5 * dy);
    for (let k = 0; k < 3; k++) {
      const lit = 1.05 * HAZE_COLOR[k] + 0.25 * radiance[k] + 0.6 * sun * KEY_RADIANCE[k];
      radiance[k] = mix(radiance[k] + sun * KEY_RADIANCE[k], lit, cloud);
    }
    shader.setFlat(radiance[0], radiance[1], radiance[2]);
    const across = Math.hypot(dx, dz);
    writeFrame(-dz / across, 0, dx / across, -dx, -dy, -dz, frame);
    const size = SKY_COVERAGE * spacing * Math.exp(0.05 * prng.gaussian());
    scales[0] = size * 1.1;
    scales[1] = size / 1.1;
    scales[2] = 0.1 * size;
    builder.add(
      SKY_RADIUS_M * dx,
      SKY_RADIUS_M * dy,
      SKY_RADIUS_M * dz,
      frame,
      scales,
      prng.range(0.97, 0.995),
      shader.coefficients,
    );
  }
}

const HAZE_SPLATS = 500;

/** Large faint veils in the valley between the meadow and the hills. */
function emitHaze(count: number, { builder, shader, prng }: Studio): void {
  const frame = new Float64Array(9);
  const scales = new Float64Array(3);
  const widening = Math.min(1.5, Math.sqrt(HAZE_SPLATS / count));
  for (let i = 0; i < count; i++) {
    const angle = 2 * Math.PI * ((i * GOLDEN_RATIO_CONJUGATE) % 1);
    const distance = prng.range(24, 52);
    const cos = Math.cos(angle);
    const sin = Math.sin(angle);
    shader.setFlat(hazeColor(cos, sin, 0), hazeColor(cos, sin, 1), hazeColor(cos, sin, 2));
    writeFrame(-sin, 0, cos, -cos, 0, -sin, frame);
    scales[0] = widening * prng.range(3, 7);
    scales[1] = widening * prng.range(0.4, 1.1);
    scales[2] = 0.5;
    const y = GROUND_Y + prng.range(0.2, 2.2);
    builder.add(
      distance * cos,
      y,
      distance * sin,
      frame,
      scales,
      prng.range(0.01, 0.06),
      shader.coefficients,
    );
  }
}

/** Contact-shadow splats in the full scene; other numbers of them cover the same area. */
const CONTACT_SPLATS = 400;
const CONTACT_COLOR: Rgb = [0.035, 0.018, 0.01];

/** Faint dark discs where objects touch the table, finer than the marched shade. */
function emitContactShadows(count: number, { builder, shader, prng }: Studio): void {
  const frame = new Float64Array(9);
  const scales = new Float64Array(3);
  writeFrame(1, 0, 0, 0, 1, 0, frame);
  const widening = Math.min(1.5, Math.sqrt(CONTACT_SPLATS / count));
  for (let i = 0; i < count; i++) {
    const footprint = FOOTPRINTS[i % FOOTPRINTS.length];
    const angle = prng.range(0, 2 * Math.PI);
    const radius = footprint.radius * prng.range(0.6, 1.12);
    shader.setFlat(CONTACT_COLOR[0], CONTACT_COLOR[1], CONTACT_COLOR[2]);
    const size = footprint.radius * widening * prng.range(0.16, 0.3);
    scales[0] = size;
    scales[1] = size * prng.range(0.6, 1);
    scales[2] = 0.0012;
    builder.add(
      footprint.x + radius * Math.cos(angle),
      0.003,
      footprint.z + radius * Math.sin(angle),
      frame,
      scales,
      prng.range(0.03, 0.16),
      shader.coefficients,
    );
  }
}

const BLADE_SEGMENTS = 2;

function placeBlade(blade: number, t: number, out: Float64Array): void {
  const clump = Math.floor(blade / 7);
  const angle = 2 * Math.PI * ((clump * GOLDEN_RATIO_CONJUGATE) % 1);
  const distance = TERRACE_RADIUS + 0.1 + 3.5 * latticeHash(clump, 2, 3) ** 2;
  const length = mix(0.07, 0.3, latticeHash(blade, 3, 3) ** 1.5);
  const lean = 0.75 * (latticeHash(blade, 4, 3) - 0.5);
  const leanZ = 0.75 * (latticeHash(blade, 5, 3) - 0.5);
  out[0] =
    distance * Math.cos(angle) + 0.3 * (latticeHash(blade, 6, 3) - 0.5) + length * lean * t * (0.6 + 0.6 * t);
  out[2] =
    distance * Math.sin(angle) +
    0.3 * (latticeHash(blade, 7, 3) - 0.5) +
    length * leanZ * t * (0.6 + 0.6 * t);
  out[1] = GROUND_Y - 0.02 + length * t * (1 - 0.2 * t);
}

export const landscapeParts: readonly Part[] = [
  { name: 'sky', weight: 5_500, role: 'sparse', work: 0.1, emit: emitSky },
  ...RIDGES.map((ridge, index) => ({
    name: `ridge-${index}`,
    weight: 2_800,
    role: 'sparse' as const,
    work: 0.2,
    emit: (count: number, studio: Studio) => emitRidge(ridge, count, studio),
  })),
  { name: 'trees', weight: TREES * TREE_SPLATS, role: 'sparse', work: 0.1, emit: emitTrees },
  { name: 'haze', weight: HAZE_SPLATS, role: 'detail', work: 0.1, emit: emitHaze },
  surfacePart({
    name: 'ground',
    weight: 24_000,
    role: 'ground',
    work: 0.2,
    surface: new GroundSurface(),
    owner: 'ground',
    coverage: 0.8,
    // A large splat as thick as others are would rise above the paving as fog.
    thickest: 0.012,
    finish: groundFinish,
  }),
  {
    name: 'meadow-grass',
    weight: 9_000,
    role: 'detail',
    work: 0.5,
    emit: (count, studio) => {
      emitFibres(count, studio, {
        segments: BLADE_SEGMENTS,
        radius: 0.0026,
        color: (blade, t, out) => {
          const dry = clamp01(0.5 * t + 0.9 * latticeHash(Math.floor(blade / 7), 8, 3) - 0.1);
          for (let k = 0; k < 3; k++) out[k] = mix(1.3 * GRASS[k], 1.5 * GRASS_DRY[k], dry);
        },
        gloss: 0.05,
        opacity: [0.6, 0.95],
        owner: 'meadow',
        place: placeBlade,
        exposure: (_, t) => 0.4 + 0.6 * t,
      });
    },
  },
  { name: 'contact-shadows', weight: CONTACT_SPLATS, work: 0.1, emit: emitContactShadows },
];
