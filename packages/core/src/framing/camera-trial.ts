import type { Vec3 } from '../data/math/mat4.ts';
import { cross, negated, plus, scaled, unit } from '../data/math/vec3.ts';
import { FITTED_PART, FittedScene } from './fitted-scene.ts';
import { exp, log, sinCos } from './portable-math.ts';
import type { SceneDetail } from './scene-detail.ts';
import type { SceneKind } from './scene-framing.ts';
import { type TrialPicture, type TrialShape, TrialViews } from './trial-view.ts';

/** Splats that trial pictures draw: of all candidates, of an object from above and below, of the best. */
const FEW = 2048;
const SOME = 4096;
const MANY = 8192;
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
/** Cameras within surroundings look so little down, at most, that the horizon is in the picture. */
const HORIZON_ELEVATION = 8 * DEGREE;
/** Places of a grid, of so many on a side, that cameras within a scene are tried at. */
const INSIDE_GRID = 7;
/** Height of their eyes, as a part of the height of most detail. */
const EYES = 0.5;
/** Distance of the point about which a camera within a scene turns, before it is known. */
const INSIDE_DISTANCE = 0.5;
/** Elevations from which an object is looked at, above and below, to find which way up it is. */
const ABOVE = [30 * DEGREE, 60 * DEGREE];

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
  readonly some: TrialViews;
  readonly many: TrialViews;
}

export function sharedViews(detail: SceneDetail, shape: TrialShape): SharedViews {
  const [few, some, many] = [FEW, SOME, MANY].map((splats) => new TrialViews(detail, splats, shape));
  return { few, some, many };
}

/** Tries cameras of a scene with this up. */
export class CameraTrial {
  readonly up: Vec3;
  readonly #x: Vec3;
  readonly #z: Vec3;
  readonly #shape: TrialShape;
  readonly #views: SharedViews;
  readonly #fitted: FittedScene;
  /** Elevation from which the scene is seen best, in radians. */
  readonly #bestElevation: number;

  constructor(detail: SceneDetail, up: Vec3, shape: TrialShape, views: SharedViews) {
    this.up = up;
    this.#x = unit(cross(up, Math.abs(up[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    this.#z = cross(this.#x, up);
    this.#shape = shape;
    this.#views = views;
    this.#fitted = new FittedScene(detail, up, shape);
    this.#bestElevation = this.#fitted.bestElevation([this.#x, this.#z]);
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
      const { target, distance } = this.#fitted.whole(back);
      visible += this.#views.some.picture(
        { position: plus(target, back, distance), target },
        this.up,
      ).visible;
    }
    return visible;
  }

  /** The best camera for a scene of this kind, a little improved. */
  refined(kind: SceneKind, first: Tried): { readonly position: Vec3; readonly target: Vec3 } {
    const best = this.#refined(kind, first);
    return { position: best.position, target: kind === 'enclosed' ? this.#seenPoint(best) : best.target };
  }

  /** Point on the camera's axis, at the picture's depth but at least `INSIDE_DISTANCE` away. */
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
      const distance = this.#fitted.nearDistance(back);
      const camera = { position: scaled(back, distance), target: scaled(back, 1.3 * distance) };
      empty += this.#views.many.picture(camera, this.up).empty;
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
      const picture = this.#views.many.picture({ position, target }, this.up);
      sharp += picture.sharp / OUTWARDS.length;
      empty += picture.empty / OUTWARDS.length;
    }
    return sharp * (1 - empty);
  }

  /** The best of all candidates for a scene of this kind. */
  best(kind: SceneKind): Tried {
    const first = this.#tried(kind, this.#candidates(kind), this.#views.few);
    const others = first
      .slice(0, kind === 'enclosed' ? 0 : FIRST_BEST)
      .flatMap(({ azimuth, distance }) => this.#otherElevations(kind, azimuth, distance));
    const ranked = [...first, ...this.#tried(kind, others, this.#views.few)].sort(
      (a, b) => b.score - a.score,
    );
    const finalists = this.#tried(kind, ranked.slice(0, FINALISTS), this.#views.many);
    if (finalists.length > 0) return finalists[0];
    // Every camera would be below the ground.
    const camera = {
      azimuth: FIRST_AZIMUTH,
      elevation: FIRST_ELEVATION,
      distance: 2.5,
      target: [0, 0, 0] as Vec3,
    };
    return this.#try(kind, camera, this.#views.many);
  }

  #candidates(kind: SceneKind): Candidate[] {
    if (kind === 'enclosed') return this.#insideCandidates();
    return AZIMUTHS.flatMap((azimuth) => this.#outsideCandidates(kind, azimuth));
  }

  #otherElevations(kind: SceneKind, azimuth: number, distance: number): Candidate[] {
    return OTHER_ELEVATIONS.map((elevation) =>
      kind === 'object'
        ? { azimuth, elevation, ...this.#fitted.whole(this.#back(azimuth, elevation)) }
        : { azimuth, elevation, distance, target: [0, 0, 0] },
    );
  }

  #outsideCandidates(kind: SceneKind, azimuth: number): Candidate[] {
    const elevation = FIRST_ELEVATION;
    const back = this.#back(azimuth, elevation);
    if (kind === 'object') return [{ azimuth, elevation, ...this.#fitted.whole(back) }];
    const target: Vec3 = [0, 0, 0];
    const far = this.#fitted.nearDistance(back);
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
    const [minX, maxX] = this.#fitted.range(this.#x, 0.05);
    const [minZ, maxZ] = this.#fitted.range(this.#z, 0.05);
    const [bottom, top] = this.#fitted.range(this.up, 0.05);
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

  /** Tries the candidates above the ground, and sorts them by score, best first. */
  #tried(kind: SceneKind, candidates: readonly Candidate[], views: TrialViews): Tried[] {
    const above = candidates.filter((candidate) => this.#fitted.isAboveGround(this.#positionOf(candidate)));
    return above.map((candidate) => this.#try(kind, candidate, views)).sort((a, b) => b.score - a.score);
  }

  #positionOf({ azimuth, elevation, distance, target }: Candidate): Vec3 {
    return plus(target, this.#back(azimuth, elevation), distance);
  }

  #try(kind: SceneKind, candidate: Candidate, views: TrialViews): Tried {
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
      score: this.#score(kind, elevation, picture),
    };
  }

  #score(kind: SceneKind, elevation: number, picture: TrialPicture): number {
    const { framed, interesting, sharp, sharpInMiddle, background, fog, empty } = picture;
    const penalty = 2.5 * fog + (kind === 'surrounded' ? empty : 0);
    const quality = (0.5 * sharp + 0.5 * sharpInMiddle + 0.3 * background) * exp(-penalty);
    if (!(quality > 0)) return 0;
    const isInside = kind === 'enclosed';
    const tilt = (elevation - this.#bestElevationOf(kind)) / (26 * DEGREE);
    // Splats behind a wall are in the frame as well, so `framed` does not count inside a scene.
    if (isInside) return interesting * exp(0.7 * log(quality) - tilt * tilt);
    const [interest, clearness] = kind === 'object' ? [0.75, 0.5] : [0.5, 0.7];
    return framed * exp(interest * log(interesting) + clearness * log(quality) - tilt * tilt);
  }

  #bestElevationOf(kind: SceneKind): number {
    if (kind === 'enclosed') return INSIDE_ELEVATION;
    return kind === 'object' ? this.#bestElevation : Math.min(HORIZON_ELEVATION, this.#bestElevation);
  }

  /** A better camera close by. */
  #refined(kind: SceneKind, first: Tried): Tried {
    let best = first;
    for (const step of [1, 1, 0.5, 0.5]) {
      const [next] = this.#tried(kind, this.#neighbours(kind, best, step), this.#views.many);
      if (next && next.score > best.score) best = next;
    }
    return best;
  }

  #neighbours(
    kind: SceneKind,
    { azimuth, elevation, distance, target }: Candidate,
    step: number,
  ): Candidate[] {
    const turned = [
      { azimuth: azimuth + 0.26 * step, elevation },
      { azimuth: azimuth - 0.26 * step, elevation },
      { azimuth, elevation: elevation + 0.12 * step },
      { azimuth, elevation: Math.max(0.03, elevation - 0.12 * step) },
    ];
    if (kind === 'object')
      return turned.map((turn) => ({
        ...turn,
        ...this.#fitted.whole(this.#back(turn.azimuth, turn.elevation)),
      }));
    if (kind === 'enclosed') return this.#insideNeighbours({ azimuth, elevation, distance, target }, step);
    const { right, above } = this.#fitted.axes(this.#back(azimuth, elevation));
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
      this.#insideCandidate(place, azimuth, Math.max(0, elevation + tilt)),
    );
    const moves = [this.#x, this.#z].flatMap((axis) =>
      [shift, -shift].map((by) => this.#insideCandidate(plus(place, axis, by), azimuth, elevation)),
    );
    return [...turns, ...tilts, ...moves];
  }
}
