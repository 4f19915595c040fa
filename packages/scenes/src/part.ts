import { applyPose, type Pose } from './pose.ts';
import type { Prng } from './prng.ts';
import { Finish, type Shader } from './shading.ts';
import type { SplatBuilder } from './splat-builder.ts';
import { type Surface, SurfacePoint, sampleLattice } from './surface-sampling.ts';

/** Tools with which a part makes its splats. */
export interface Studio {
  readonly builder: SplatBuilder;
  readonly shader: Shader;
  /** The part's own stream of random numbers. */
  readonly prng: Prng;
  /** How much wider fibres are than in the full scene, so that fewer of them still fill a tuft. */
  readonly fibreWidening: number;
}

/**
 * Role of a part in the scene. Small scenes spend the same share of their splats on the subject, less on scattered detail,
 * more on parts that would otherwise become unrecognisable (hills, sky, trees, plumes), and somewhat more on the ground:
 * if its splats grew as their number falls, a camera above them would see them as fog.
 */
export type PartRole = 'subject' | 'detail' | 'sparse' | 'ground';

/** A part of a scene that can be made of any number of splats. */
export interface Part {
  readonly name: string;
  /** Share in the full scene, about in splats. */
  readonly weight: number;
  /** How the part's share changes in small scenes; `subject` where absent. */
  readonly role?: PartRole;
  /** Work per splat, compared with that of glossy discs among other objects; 1 where absent. */
  readonly work?: number;
  /** Adds exactly `count` splats. */
  emit(count: number, studio: Studio): void;
}

/** A part that covers a surface with discs. */
interface SurfacePart {
  readonly name: string;
  readonly weight: number;
  readonly role?: PartRole;
  /** As in {@link Part}. */
  readonly work?: number;
  readonly surface: Surface;
  readonly pose?: Pose;
  /** Object that the surface belongs to; it does not occlude itself. */
  readonly owner: string;
  /** Describes the material at a point; starts from a fresh {@link Finish}. */
  readonly finish: (point: SurfacePoint, finish: Finish) => void;
  /** Standard deviation of a disc over its spacing; {@link COVERAGE} where absent. */
  readonly coverage?: number;
  /** Largest standard deviation along the normal, in metres; unlimited where absent. */
  readonly thickest?: number;
  /** Share of faint, wider splats; {@link FAINT_SHARE} where absent. */
  readonly faintShare?: number;
  /** Relief along the normal, in metres, over the object's own frame. */
  readonly relief?: (x: number, y: number, z: number) => number;
}

/** Standard deviation of a disc over its spacing: at 0.6 neighbours overlap enough that no gap shows through. */
const COVERAGE = 0.62;
/** Standard deviation of a splat's offset from its lattice point, over the spacing: hides the lattice's spirals. */
const JITTER = 0.14;
/** Standard deviation of the logarithm of a disc's size. */
const SIZE_SPREAD = 0.13;
/** Standard deviation of the logarithm of a disc's length over width. */
const ASPECT_SPREAD = 0.28;
/** A disc is this many times thinner than wide. */
const FLATNESS_LOW = 5;
const FLATNESS_HIGH = 20;
/** Share of faint, wider splats on every surface, as training leaves them. */
const FAINT_SHARE = 0.04;
const FAINT_OPACITY_LOW = 0.04;
const FAINT_OPACITY_HIGH = 0.35;
const FAINT_WIDENING = 1.35;
/** Step for the relief's slope: a quarter of a millimetre, below the finest dimple. */
const RELIEF_STEP_M = 2.5e-4;

export function surfacePart(part: SurfacePart): Part {
  const { name, weight, role, work } = part;
  return { name, weight, role, work, emit: (count, studio) => emitSurface(part, count, studio) };
}

function emitSurface(part: SurfacePart, count: number, { builder, shader, prng }: Studio): void {
  const point = new SurfacePoint();
  const finish = new Finish();
  const frame = new Float64Array(9);
  const scales = new Float64Array(3);
  const { coverage = COVERAGE, faintShare = FAINT_SHARE, thickest = Number.POSITIVE_INFINITY } = part;
  for (let i = 0; i < count; i++) {
    sampleLattice(part.surface, i, count, point);
    if (part.relief !== undefined) applyRelief(part.relief, point);
    if (part.pose !== undefined) applyPose(part.pose, point);
    finish.reset();
    part.finish(point, finish);
    if (finish.grainAspect > 1) alignFrame(point, finish.grainX, 0, finish.grainZ, frame);
    else randomFrame(point, prng.range(0, 2 * Math.PI), frame);
    const along = JITTER * point.spacing * prng.gaussian();
    const across = JITTER * point.spacing * prng.gaussian();
    const x = point.x + along * frame[0] + across * frame[3];
    const y = point.y + along * frame[1] + across * frame[4];
    const z = point.z + along * frame[2] + across * frame[5];
    const aspect = finish.grainAspect * Math.exp(ASPECT_SPREAD * prng.gaussian());
    let size = coverage * point.spacing * Math.exp(SIZE_SPREAD * prng.gaussian());
    // Squared towards the upper end: most splats of a trained surface are nearly opaque.
    const draw = prng.next();
    let opacity = finish.opacityHigh - (finish.opacityHigh - finish.opacityLow) * draw * draw;
    if (prng.next() < faintShare) {
      opacity *= prng.range(FAINT_OPACITY_LOW, FAINT_OPACITY_HIGH);
      size *= FAINT_WIDENING;
    }
    scales[0] = size * Math.sqrt(aspect);
    scales[1] = size / Math.sqrt(aspect);
    const flatness = FLATNESS_LOW * (FLATNESS_HIGH / FLATNESS_LOW) ** prng.next();
    scales[2] = Math.min(Math.min(scales[0], scales[1]) / flatness, thickest);
    shader.shadeSurface(x, y, z, frame, finish, part.owner);
    builder.add(x, y, z, frame, scales, opacity, shader.coefficients);
  }
}

/** Moves a point out by the relief and tilts its normal by the relief's slope. */
function applyRelief(relief: (x: number, y: number, z: number) => number, point: SurfacePoint): void {
  const { localX: x, localY: y, localZ: z } = point;
  const height = relief(x, y, z);
  const slopeX = (relief(x + RELIEF_STEP_M, y, z) - height) / RELIEF_STEP_M;
  const slopeY = (relief(x, y + RELIEF_STEP_M, z) - height) / RELIEF_STEP_M;
  const slopeZ = (relief(x, y, z + RELIEF_STEP_M) - height) / RELIEF_STEP_M;
  const { normalX, normalY, normalZ } = point;
  const along = slopeX * normalX + slopeY * normalY + slopeZ * normalZ;
  point.x += normalX * height;
  point.y += normalY * height;
  point.z += normalZ * height;
  const tiltedX = normalX - slopeX + along * normalX;
  const tiltedY = normalY - slopeY + along * normalY;
  const tiltedZ = normalZ - slopeZ + along * normalZ;
  const length = Math.hypot(tiltedX, tiltedY, tiltedZ);
  point.normalX = tiltedX / length;
  point.normalY = tiltedY / length;
  point.normalZ = tiltedZ / length;
}

/** Axes with the point's normal third and the first as near to (x, y, z) as the surface allows. */
function alignFrame(point: SurfacePoint, x: number, y: number, z: number, frame: Float64Array): void {
  const { normalX, normalY, normalZ } = point;
  const along = x * normalX + y * normalY + z * normalZ;
  let tx = x - along * normalX;
  let ty = y - along * normalY;
  let tz = z - along * normalZ;
  const length = Math.hypot(tx, ty, tz);
  if (length < 1e-3) {
    randomFrame(point, 0, frame);
    return;
  }
  tx /= length;
  ty /= length;
  tz /= length;
  writeFrame(tx, ty, tz, normalX, normalY, normalZ, frame);
}

/** Axes with the point's normal third, turned about it by `angle` radians. */
function randomFrame({ normalX, normalY, normalZ }: SurfacePoint, angle: number, frame: Float64Array): void {
  // Any vector that is not along the normal will do: the axis with the normal's smallest component.
  let tx: number;
  let ty: number;
  let tz: number;
  if (Math.abs(normalY) < 0.9) {
    const length = Math.hypot(normalX, normalZ);
    tx = normalZ / length;
    ty = 0;
    tz = -normalX / length;
  } else {
    const length = Math.hypot(normalY, normalZ);
    tx = 0;
    ty = normalZ / length;
    tz = -normalY / length;
  }
  const bx = normalY * tz - normalZ * ty;
  const by = normalZ * tx - normalX * tz;
  const bz = normalX * ty - normalY * tx;
  const cos = Math.cos(angle);
  const sin = Math.sin(angle);
  writeFrame(cos * tx + sin * bx, cos * ty + sin * by, cos * tz + sin * bz, normalX, normalY, normalZ, frame);
}

/** Completes unit x and z axes, at right angles, to a right-handed frame. */
export function writeFrame(
  tx: number,
  ty: number,
  tz: number,
  nx: number,
  ny: number,
  nz: number,
  frame: Float64Array,
): void {
  frame[0] = tx;
  frame[1] = ty;
  frame[2] = tz;
  frame[3] = ny * tz - nz * ty;
  frame[4] = nz * tx - nx * tz;
  frame[5] = nx * ty - ny * tx;
  frame[6] = nx;
  frame[7] = ny;
  frame[8] = nz;
}
