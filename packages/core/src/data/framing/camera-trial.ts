import type { Vec3 } from '../math/mat4.ts';
import { cross, dot, negated, plus, unit } from './directions.ts';
import { exp, log, sinCos } from './portable-math.ts';
import type { SceneDetail } from './scene-detail.ts';
import type { SceneKind } from './scene-framing.ts';
import { type FrameShape, type TrialPicture, TrialViews } from './trial-view.ts';
import { weightedQuantile, weightedQuantiles } from './weighted-quantile.ts';

/** Splats that trial pictures draw, of all candidates and of the best of them. */
const FEW = 2048;
const MANY = 8192;
/** Splats by which distances are fitted. */
const FITTED = 2048;
/** Candidates that are drawn again with more splats. */
const FINALISTS = 12;
const DEGREE = Math.PI / 180;
const FIRST_AZIMUTH = 0.35;
const AZIMUTHS = Array.from({ length: 12 }, (_, i) => FIRST_AZIMUTH + (i * Math.PI) / 6);
/** Azimuths of pictures that look outwards. */
const OUTWARDS = AZIMUTHS.filter((_, i) => i % 2 === 0);
const FIRST_ELEVATION = 18 * DEGREE;
/** Elevations that are tried with the best azimuths and distances of the first. */
const OTHER_ELEVATIONS = [6 * DEGREE, 32 * DEGREE];
const FIRST_BEST = 8;
/** Cameras within a scene look a little down. */
const INSIDE_ELEVATION = 5 * DEGREE;
/** Places of a grid, of so many on a side, that cameras within a scene are tried at. */
const INSIDE_GRID = 7;
/** Height of their eyes, as a part of the height of most detail. */
const EYES = 0.5;
/** Distance of the point about which a camera within a scene turns, before it is known. */
const INSIDE_DISTANCE = 0.3;
/** Elevations from which an object is looked at, above and below, to find which way up it is. */
const ABOVE = [30 * DEGREE, 60 * DEGREE];
/** Splats beyond so many times the reach of most detail are no part of an object. */
const STRAY = 3;
/** Nearest camera before an object, which may be a single splat. */
const LEAST_DISTANCE = 1.5;
/** Part of the frame's half height and width that what is fitted may take. */
const FITTED_PART = 0.9;

interface Candidate {
  readonly azimuth: number;
  readonly elevation: number;
  readonly distance: number;
  readonly target: Vec3;
}

export interface Tried extends Candidate {
  readonly score: number;
  readonly position: Vec3;
  readonly picture: TrialPicture;
}

/** How much is seen outwards, which tells the kind of a scene. */
export interface SeenOutwards {
  /** From around it. */
  readonly around: number;
  /** From within. */
  readonly inside: number;
}

/** Pictures of a scene, which any number of trials share. */
export interface SharedViews {
  readonly few: TrialViews;
  readonly many: TrialViews;
}

export function sharedViews(detail: SceneDetail, shape: FrameShape): SharedViews {
  return { few: new TrialViews(detail, FEW, shape), many: new TrialViews(detail, MANY, shape) };
}

/** Tries cameras of a scene with this up. */
export class CameraTrial {
  readonly up: Vec3;
  readonly #x: Vec3;
  readonly #z: Vec3;
  readonly #shape: FrameShape;
  readonly #few: TrialViews;
  readonly #many: TrialViews;
  readonly #fitted: FittedSplats;
  #kind: SceneKind = 'object';
  /** Elevation from which the scene is seen best, in radians. */
  readonly #bestElevation: number;

  constructor(detail: SceneDetail, up: Vec3, shape: FrameShape, { few, many }: SharedViews) {
    this.up = up;
    this.#x = unit(cross(up, Math.abs(up[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    this.#z = cross(this.#x, up);
    this.#shape = shape;
    this.#few = few;
    this.#many = many;
    this.#fitted = fittedSplats(detail, up);
    this.#bestElevation = bestElevation(this.#fitted, this.#x, this.#z);
  }

  seenOutwards(): SeenOutwards {
    return { around: this.#seenAround(), inside: this.#seenInside() };
  }

  /** How many times more of an object is visible from above than from below. */
  excessFromAbove(): number {
    const [above, below] = [1, -1].map((side) => {
      const visible = ABOVE.map((elevation) => this.#visibleFrom(side * elevation));
      return Math.sqrt(visible[0] * visible[1]);
    });
    return below > 0 ? above / below : 1;
  }

  #visibleFrom(elevation: number): number {
    let visible = 0;
    for (const azimuth of OUTWARDS) {
      const back = this.#back(azimuth, elevation);
      const { target, distance } = this.#whole(back);
      visible += this.#few.picture({ position: plus(target, back, distance), target }, this.up).visible;
    }
    return visible;
  }

  /** The best camera for a scene of this kind, a little improved. */
  refined(kind: SceneKind, first: Tried): { readonly position: Vec3; readonly target: Vec3 } {
    this.#kind = kind;
    const best = this.#refined(first);
    return { position: best.position, target: kind === 'enclosed' ? this.#seenPoint(best) : best.target };
  }

  /** The point in the middle of the picture at the depth of what is seen. */
  #seenPoint({ position, target, picture }: Tried): Vec3 {
    const forward = unit(plus(target, position, -1));
    return plus(position, forward, Math.max(picture.depth, INSIDE_DISTANCE));
  }

  #back(azimuth: number, elevation: number): Vec3 {
    const [sinA, cosA] = sinCos(azimuth);
    const [sinE, cosE] = sinCos(elevation);
    const level = plus(scaled(this.#x, sinA), this.#z, cosA);
    return plus(scaled(level, cosE), this.up, sinE);
  }

  /** How full pictures are that look outwards from around the scene. */
  #seenAround(): number {
    let empty = 0;
    for (const azimuth of OUTWARDS) {
      const back = this.#back(azimuth, 0.02);
      const distance = this.#fitDistance(back, this.#fitted.nearDetails, 0.95, [0, 0, 0]);
      const camera = { position: scaled(back, distance), target: scaled(back, 1.3 * distance) };
      empty += this.#many.picture(camera, this.up).empty;
    }
    return 1 - empty / OUTWARDS.length;
  }

  /** How sharp and full pictures are that look outwards from the place near the middle where most are. */
  #seenInside(): number {
    const places: Vec3[] = [
      [0, 0, 0],
      ...[this.#x, negated(this.#x), this.#z, negated(this.#z)].map((axis) => scaled(axis, 0.6)),
    ];
    return Math.max(...places.map((position) => this.#seenFrom(position)));
  }

  #seenFrom(position: Vec3): number {
    let [sharp, empty] = [0, 0];
    for (const azimuth of OUTWARDS) {
      const target = plus(position, this.#back(azimuth, 0), 0.3);
      const picture = this.#many.picture({ position, target }, this.up);
      sharp += picture.sharp / OUTWARDS.length;
      empty += picture.empty / OUTWARDS.length;
    }
    return sharp * (1 - empty);
  }

  /** The best of all candidates for a scene of this kind. */
  best(kind: SceneKind): Tried {
    this.#kind = kind;
    const first = this.#tried(this.#candidates(), this.#few);
    const others = first
      .slice(0, kind === 'enclosed' ? 0 : FIRST_BEST)
      .flatMap(({ azimuth, distance }) => this.#otherElevations(azimuth, distance));
    const ranked = [...first, ...this.#tried(others, this.#few)].sort((a, b) => b.score - a.score);
    const finalists = this.#tried(ranked.slice(0, FINALISTS), this.#many);
    if (finalists.length > 0) return finalists[0];
    // Every camera would be below the ground.
    const camera = {
      azimuth: FIRST_AZIMUTH,
      elevation: FIRST_ELEVATION,
      distance: 2.5,
      target: [0, 0, 0] as Vec3,
    };
    return this.#try(camera, this.#many);
  }

  #candidates(): Candidate[] {
    if (this.#kind === 'enclosed') return this.#insideCandidates();
    return AZIMUTHS.flatMap((azimuth) => this.#outsideCandidates(azimuth, FIRST_ELEVATION));
  }

  #otherElevations(azimuth: number, distance: number): Candidate[] {
    return OTHER_ELEVATIONS.map((elevation) =>
      this.#kind === 'object'
        ? { azimuth, elevation, ...this.#whole(this.#back(azimuth, elevation)) }
        : { azimuth, elevation, distance, target: [0, 0, 0] },
    );
  }

  #outsideCandidates(azimuth: number, elevation: number): Candidate[] {
    const back = this.#back(azimuth, elevation);
    if (this.#kind === 'object') return [{ azimuth, elevation, ...this.#whole(back) }];
    const target: Vec3 = [0, 0, 0];
    const far = this.#fitDistance(back, this.#fitted.nearDetails, 0.95, target);
    const near = [1, 0.65].filter((distance) => distance < 0.5 * far);
    return [far, 0.75 * far, 0.55 * far, ...near].map((distance) => ({
      azimuth,
      elevation,
      distance,
      target,
    }));
  }

  /** Places all over the scene at the height of eyes, and all directions. */
  #insideCandidates(): Candidate[] {
    const { count, heights, nearDetails } = this.#fitted;
    const rangeOf = (values: Float64Array) => weightedQuantiles(values, nearDetails, count, [0.05, 0.95]);
    const [minX, maxX] = rangeOf(alongAxis(this.#fitted, this.#x));
    const [minZ, maxZ] = rangeOf(alongAxis(this.#fitted, this.#z));
    const [bottom, top] = rangeOf(heights);
    const steps = Array.from({ length: INSIDE_GRID }, (_, i) => (i + 0.5) / INSIDE_GRID);
    return steps.flatMap((u) =>
      steps.flatMap((v) => {
        const level = plus(scaled(this.#x, minX + u * (maxX - minX)), this.#z, minZ + v * (maxZ - minZ));
        const place = plus(level, this.up, bottom + EYES * (top - bottom));
        return OUTWARDS.map((azimuth) => this.#insideCandidate(place, azimuth, INSIDE_ELEVATION));
      }),
    );
  }

  #insideCandidate(place: Vec3, azimuth: number, elevation: number): Candidate {
    const target = plus(place, this.#back(azimuth, elevation), -INSIDE_DISTANCE);
    return { azimuth, elevation, distance: INSIDE_DISTANCE, target };
  }

  /** Those above the ground, the best first. */
  #tried(candidates: readonly Candidate[], views: TrialViews): Tried[] {
    const above = candidates.filter((candidate) => this.#isAboveGround(this.#positionOf(candidate)));
    return above.map((candidate) => this.#try(candidate, views)).sort((a, b) => b.score - a.score);
  }

  #positionOf({ azimuth, elevation, distance, target }: Candidate): Vec3 {
    return plus(target, this.#back(azimuth, elevation), distance);
  }

  #try(candidate: Candidate, views: TrialViews): Tried {
    const position = this.#positionOf(candidate);
    const picture = views.picture({ position, target: candidate.target }, this.up);
    const { azimuth, elevation, distance, target } = candidate;
    return {
      azimuth,
      elevation,
      distance,
      target,
      position,
      picture,
      score: this.#score(elevation, picture),
    };
  }

  #score(elevation: number, picture: TrialPicture): number {
    const { framed, visible, sharp, sharpInMiddle, background, fog, empty } = picture;
    const penalty = 2.5 * fog + (this.#kind === 'surrounded' ? empty : 0);
    const quality = (0.5 * sharp + 0.5 * sharpInMiddle + 0.3 * background) * exp(-penalty);
    if (!(quality > 0)) return 0;
    const isInside = this.#kind === 'enclosed';
    const tilt = (elevation - (isInside ? INSIDE_ELEVATION : this.#bestElevation)) / (26 * DEGREE);
    // Within a scene, what is behind a wall is in the frame as well.
    if (isInside) return Math.sqrt(visible) * exp(0.7 * log(quality) - tilt * tilt);
    return framed * Math.sqrt(visible) * exp(0.7 * log(quality) - tilt * tilt);
  }

  /** A better camera close by. */
  #refined(first: Tried): Tried {
    let best = first;
    for (const step of [1, 1, 0.5, 0.5]) {
      const [next] = this.#tried(this.#neighbours(best, step), this.#many);
      if (next && next.score > best.score) best = next;
    }
    return best;
  }

  #neighbours({ azimuth, elevation, distance, target }: Candidate, step: number): Candidate[] {
    const turned = [
      { azimuth: azimuth + 0.26 * step, elevation },
      { azimuth: azimuth - 0.26 * step, elevation },
      { azimuth, elevation: elevation + 0.12 * step },
      { azimuth, elevation: Math.max(0.03, elevation - 0.12 * step) },
    ];
    if (this.#kind === 'object')
      return turned.map((turn) => ({ ...turn, ...this.#whole(this.#back(turn.azimuth, turn.elevation)) }));
    if (this.#kind === 'enclosed')
      return this.#insideNeighbours({ azimuth, elevation, distance, target }, step);
    const { right, above } = this.#axes(this.#back(azimuth, elevation));
    const shift = 0.25 * step * distance * FITTED_PART * this.#shape.tangentY;
    const factor = step === 1 ? 1.2 : 1.0954451150103321;
    return [
      ...turned.map((turn) => ({ ...turn, distance, target })),
      ...[distance * factor, distance / factor].map((moved) => ({
        azimuth,
        elevation,
        distance: moved,
        target,
      })),
      ...[right, negated(right), above, negated(above)].map((axis) => ({
        azimuth,
        elevation,
        distance,
        target: plus(target, axis, shift),
      })),
    ];
  }

  #insideNeighbours(candidate: Candidate, step: number): Candidate[] {
    const { azimuth, elevation } = candidate;
    const place = this.#positionOf(candidate);
    const shift = 0.15 * step;
    const turns = [0.26 * step, -0.26 * step].map((turn) =>
      this.#insideCandidate(place, azimuth + turn, elevation),
    );
    const tilts = [0.1 * step, -0.1 * step].map((tilt) =>
      this.#insideCandidate(place, azimuth, elevation + tilt),
    );
    const moves = [this.#x, this.#z, this.up].flatMap((axis) =>
      [shift, -shift].map((by) => this.#insideCandidate(plus(place, axis, by), azimuth, elevation)),
    );
    return [...turns, ...tilts, ...moves];
  }

  #axes(back: Vec3): { readonly right: Vec3; readonly above: Vec3 } {
    const right = unit(cross(negated(back), this.up));
    return { right, above: cross(right, negated(back)) };
  }

  /** The distance from which this part of the weight about `target` is in the frame. */
  #fitDistance(back: Vec3, weights: Float64Array, part: number, target: Vec3): number {
    const { right, above } = this.#axes(back);
    const tangentX = FITTED_PART * this.#shape.tangentX;
    const tangentY = FITTED_PART * this.#shape.tangentY;
    const { count, x, y, z, scratch } = this.#fitted;
    for (let i = 0; i < count; i++) {
      const [dx, dy, dz] = [x[i] - target[0], y[i] - target[1], z[i] - target[2]];
      const across = Math.abs(dx * right[0] + dy * right[1] + dz * right[2]) / tangentX;
      const along = Math.abs(dx * above[0] + dy * above[1] + dz * above[2]) / tangentY;
      scratch[i] = Math.max(across, along) + dx * back[0] + dy * back[1] + dz * back[2];
    }
    return weightedQuantile(scratch, weights, count, part);
  }

  /** The target and distance that show the whole scene in the middle of the picture. */
  #whole(back: Vec3): { readonly target: Vec3; readonly distance: number } {
    const { count, x, y, z, details, scratch } = this.#fitted;
    const { right, above } = this.#axes(back);
    for (let i = 0; i < count; i++) scratch[i] = x[i] * back[0] + y[i] * back[1] + z[i] * back[2];
    let target = scaled(back, this.#middleOf(0.01));
    let distance = Math.max(LEAST_DISTANCE, this.#fitDistance(back, details, 0.99, target));
    for (let step = 0; step < 2; step++) {
      for (const axis of [right, above]) {
        for (let i = 0; i < count; i++) {
          const [dx, dy, dz] = [x[i] - target[0], y[i] - target[1], z[i] - target[2]];
          const depth = Math.max(distance - (dx * back[0] + dy * back[1] + dz * back[2]), 0.05 * distance);
          scratch[i] = (dx * axis[0] + dy * axis[1] + dz * axis[2]) / depth;
        }
        target = plus(target, axis, this.#middleOf(0.005) * distance);
      }
      distance = Math.max(LEAST_DISTANCE, 1.03 * this.#fitDistance(back, details, 0.995, target));
    }
    return { target, distance };
  }

  /** The middle between what this part of the detail lies below and above. */
  #middleOf(part: number): number {
    const { count, details, scratch } = this.#fitted;
    const [low, high] = weightedQuantiles(scratch, details, count, [part, 1 - part]);
    return (low + high) / 2;
  }

  #isAboveGround(position: Vec3): boolean {
    const up = this.up;
    const height = dot(position, up);
    const { count, x, y, z, heights, details, scratch, scratchWeights } = this.#fitted;
    let found = 0;
    for (let i = 0; i < count; i++) {
      if (details[i] < 0.1) continue;
      const [dx, dy, dz] = [x[i] - position[0], y[i] - position[1], z[i] - position[2]];
      const dh = heights[i] - height;
      if (dx * dx + dy * dy + dz * dz - dh * dh > 0.35 * 0.35) continue;
      scratch[found] = heights[i];
      scratchWeights[found++] = 1;
    }
    if (found < 3) return true;
    return height > weightedQuantile(scratch, scratchWeights, found, 0.15) + 0.08;
  }
}

/** A part of the splats, by which distances and heights are found. */
interface FittedSplats {
  readonly count: number;
  readonly x: Float64Array;
  readonly y: Float64Array;
  readonly z: Float64Array;
  readonly heights: Float64Array;
  readonly details: Float64Array;
  readonly nearDetails: Float64Array;
  readonly scratch: Float64Array;
  readonly scratchWeights: Float64Array;
}

function fittedSplats(detail: SceneDetail, up: Vec3): FittedSplats {
  const step = Math.max(1, Math.floor(detail.count / FITTED));
  const count = Math.ceil(detail.count / step);
  const of = (values: Float64Array) => Float64Array.from({ length: count }, (_, i) => values[i * step]);
  const [x, y, z] = [of(detail.x), of(detail.y), of(detail.z)];
  return {
    count,
    x,
    y,
    z,
    heights: x.map((value, i) => value * up[0] + y[i] * up[1] + z[i] * up[2]),
    details: of(
      detail.details.map((value, i) => (detail.distances[i] > STRAY * detail.farReach ? 0 : value)),
    ),
    nearDetails: of(detail.nearDetails),
    scratch: new Float64Array(count),
    scratchWeights: new Float64Array(count),
  };
}

/** Flat scenes are seen best from higher up. */
function bestElevation(fitted: FittedSplats, right: Vec3, back: Vec3): number {
  const { count, heights, nearDetails } = fitted;
  const spread = (values: Float64Array) => {
    const [low, high] = weightedQuantiles(values, nearDetails, count, [0.1, 0.9]);
    return high - low;
  };
  const length = Math.max(spread(alongAxis(fitted, right)), spread(alongAxis(fitted, back)));
  const flatness = length > 0 ? Math.min(1, Math.max(0, 1 - (4 * spread(heights)) / length)) : 0;
  return (14 + 18 * flatness) * DEGREE;
}

function alongAxis({ x, y, z }: FittedSplats, axis: Vec3): Float64Array {
  return x.map((value, i) => value * axis[0] + y[i] * axis[1] + z[i] * axis[2]);
}

function scaled(v: Vec3, s: number): Vec3 {
  return [v[0] * s, v[1] * s, v[2] * s];
}
