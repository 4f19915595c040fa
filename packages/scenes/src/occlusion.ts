/**
 * Shadows and ambient light by marching through the signed distances of simple stand-ins for the objects. The
 * stand-ins only have to be right to a few millimetres: only their shade is ever seen.
 */
import { KEY_DIRECTION, KEY_RADIANCE, type Rgb, skyRadiance } from './lighting.ts';
import { clamp01, smoothstep } from './noise.ts';
import { fibonacciDirections } from './sh-fit.ts';

/** A stand-in for one object. */
export interface Occluder {
  /** Which object it belongs to: an object does not shade itself, its normals do that. */
  readonly owner: string;
  /** Bounding sphere: centre and radius, metres. */
  readonly bound: readonly [x: number, y: number, z: number, radius: number];
  /** Diffuse colour, for the light that bounces off it. */
  readonly color: Rgb;
  /** Signed distance in metres from a point in the scene, negative inside; may understate, never overstate much. */
  distance(x: number, y: number, z: number): number;
}

export function sphereOccluder(
  owner: string,
  x: number,
  y: number,
  z: number,
  radius: number,
  color: Rgb,
): Occluder {
  return {
    owner,
    bound: [x, y, z, radius],
    color,
    distance: (px, py, pz) => Math.sqrt((px - x) ** 2 + (py - y) ** 2 + (pz - z) ** 2) - radius,
  };
}

/** A line from `a` to `b`, `radius` thick. */
export function capsuleOccluder(
  owner: string,
  a: readonly [number, number, number],
  b: readonly [number, number, number],
  radius: number,
  color: Rgb,
): Occluder {
  const dx = b[0] - a[0];
  const dy = b[1] - a[1];
  const dz = b[2] - a[2];
  const lengthSquared = dx * dx + dy * dy + dz * dz;
  return {
    owner,
    bound: [a[0] + dx / 2, a[1] + dy / 2, a[2] + dz / 2, Math.sqrt(lengthSquared) / 2 + radius],
    color,
    distance: (px, py, pz) => {
      const t = clamp01(((px - a[0]) * dx + (py - a[1]) * dy + (pz - a[2]) * dz) / lengthSquared);
      return (
        Math.sqrt((px - a[0] - t * dx) ** 2 + (py - a[1] - t * dy) ** 2 + (pz - a[2] - t * dz) ** 2) - radius
      );
    },
  };
}

/** A solid of revolution about a vertical axis through (x, z), given by its largest radius at evenly spaced heights. */
export function turnedOccluder(
  owner: string,
  x: number,
  z: number,
  bottomY: number,
  topY: number,
  radii: Float64Array,
  color: Rgb,
): Occluder {
  const last = radii.length - 1;
  const widest = radii.reduce((a, b) => Math.max(a, b));
  const halfHeight = (topY - bottomY) / 2;
  return {
    owner,
    bound: [x, bottomY + halfHeight, z, Math.hypot(widest, halfHeight)],
    color,
    distance: (px, py, pz) => {
      const place = clamp01((py - bottomY) / (topY - bottomY)) * last;
      const index = Math.min(place | 0, last - 1);
      const radius = radii[index] + (radii[index + 1] - radii[index]) * (place - index);
      const radial = Math.sqrt((px - x) ** 2 + (pz - z) ** 2) - radius;
      const vertical = Math.max(bottomY - py, py - topY);
      if (vertical <= 0) return Math.max(radial * 0.8, vertical);
      return radial <= 0 ? vertical : Math.sqrt(radial * radial + vertical * vertical);
    },
  };
}

/** The part below `topY` of a spherical shell: an open bowl. */
export function bowlOccluder(
  owner: string,
  center: readonly [number, number, number],
  radius: number,
  thickness: number,
  topY: number,
  color: Rgb,
): Occluder {
  return {
    owner,
    bound: [center[0], center[1], center[2], radius + thickness],
    color,
    distance: (px, py, pz) => {
      const fromCenter = Math.sqrt((px - center[0]) ** 2 + (py - center[1]) ** 2 + (pz - center[2]) ** 2);
      return Math.max(Math.abs(fromCenter - radius) - thickness / 2, py - topY);
    },
  };
}

/** Directions that ambient light is gathered from. */
const AMBIENT_DIRECTIONS = 20;
/** Distances, in metres, at which an ambient ray looks for something in its way: contact, object and table scale. */
const AMBIENT_TAPS_M = [0.012, 0.04, 0.11, 0.28];
/** A ray's cone: an occluder closer than this times the distance gone counts as being in the way. */
const AMBIENT_CONE = 0.55;
/** Furthest that an ambient ray looks, its cone included. */
const AMBIENT_REACH_M = 0.28 * (1 + AMBIENT_CONE);
/** Share of a shaded neighbour's own skylight in what it bounces. */
const BOUNCE_AMBIENT = 0.3;
/** Share of sunlight that an average point of an object's surface receives. */
const BOUNCE_KEY = 0.22;

/** Share of the bounce that remains where an ambient ray is fully blocked. */
const CREVICE_BOUNCE = 0.45;

const SHADOW_STEPS = 28;
/** No object stands further than this from a surface that it shades. */
const SHADOW_REACH_M = 1.6;
/** Distance to leave the surface by before marching. */
const SHADOW_BIAS_M = 0.003;
/** 1/tan of the key light's half-angle: how fast a penumbra widens; a little harder than the true 3.5. */
const PENUMBRA = 5;

export class OcclusionField {
  readonly #occluders: readonly Occluder[];
  readonly #directions: Float64Array;
  readonly #sky: Float64Array;
  #nearest: Occluder | undefined;
  /** Linear ambient light for a white surface, r, g, b; the last {@link gatherAmbient}'s result. */
  readonly ambient = new Float64Array(3);
  /** Share of the surroundings that the last {@link gatherAmbient} saw unobstructed, 0 to 1. */
  openness = 1;

  constructor(occluders: readonly Occluder[]) {
    this.#occluders = occluders;
    this.#directions = fibonacciDirections(AMBIENT_DIRECTIONS, -1);
    this.#sky = new Float64Array(3 * AMBIENT_DIRECTIONS);
    const radiance = new Float64Array(3);
    for (let i = 0; i < AMBIENT_DIRECTIONS; i++) {
      const [x, y, z] = this.#directions.subarray(3 * i, 3 * i + 3);
      skyRadiance(x, y, z, 0.6, radiance);
      this.#sky.set(radiance, 3 * i);
    }
  }

  /** Distance to the nearest object but `owner`'s, at most `reach`. */
  #distance(x: number, y: number, z: number, owner: string, reach: number): number {
    let nearest = reach;
    this.#nearest = undefined;
    for (const occluder of this.#occluders) {
      const { bound } = occluder;
      const dx = x - bound[0];
      const dy = y - bound[1];
      const dz = z - bound[2];
      const skip = nearest + bound[3];
      if (dx * dx + dy * dy + dz * dz > skip * skip || occluder.owner === owner) continue;
      const distance = occluder.distance(x, y, z);
      if (distance < nearest) {
        nearest = distance;
        this.#nearest = occluder;
      }
    }
    return nearest;
  }

  /** Share of the key light that reaches a point, 0 to 1, with a penumbra. */
  keyVisibility(x: number, y: number, z: number, owner: string): number {
    let visibility = 1;
    let t = SHADOW_BIAS_M;
    for (let step = 0; step < SHADOW_STEPS && t < SHADOW_REACH_M; step++) {
      const distance = this.#distance(
        x + KEY_DIRECTION[0] * t,
        y + KEY_DIRECTION[1] * t,
        z + KEY_DIRECTION[2] * t,
        owner,
        SHADOW_REACH_M,
      );
      // Half the cone is hidden when the distance is zero, all of it when it is -t / PENUMBRA.
      visibility = Math.min(visibility, 0.5 + (0.5 * PENUMBRA * distance) / t);
      if (visibility <= 0) return 0;
      t += Math.max(distance, 0.06 * t, 0.004);
    }
    return smoothstep(0, 1, visibility);
  }

  /** Gathers light other than the key's over the hemisphere about a normal into `ambient` and `openness`. */
  gatherAmbient(
    x: number,
    y: number,
    z: number,
    normalX: number,
    normalY: number,
    normalZ: number,
    owner: string,
  ): void {
    let red = 0;
    let green = 0;
    let blue = 0;
    let open = 0;
    let total = 0;
    const clearance = this.#distance(x, y, z, owner, AMBIENT_REACH_M);
    for (let i = 0; i < AMBIENT_DIRECTIONS; i++) {
      const dx = this.#directions[3 * i];
      const dy = this.#directions[3 * i + 1];
      const dz = this.#directions[3 * i + 2];
      // Wrapped a little, so that the sum changes smoothly as the normal turns past a direction.
      const weight = dx * normalX + dy * normalY + dz * normalZ + 0.1;
      if (weight <= 0) continue;
      let visibility = 1;
      let blocker: Occluder | undefined;
      for (const t of AMBIENT_TAPS_M) {
        const cone = AMBIENT_CONE * t;
        // Nothing that near: most taps of an open surface need no look.
        if (clearance >= t + cone) continue;
        const distance = this.#distance(x + dx * t, y + dy * t, z + dz * t, owner, cone);
        const seen = clamp01(0.5 + (0.5 * distance) / cone);
        if (seen < visibility) {
          visibility = seen;
          blocker = this.#nearest;
        }
      }
      red += weight * visibility * this.#sky[3 * i];
      green += weight * visibility * this.#sky[3 * i + 1];
      blue += weight * visibility * this.#sky[3 * i + 2];
      if (blocker !== undefined) {
        // A crevice sees neighbours that are dark themselves.
        const bounce = weight * (1 - visibility) * clamp01(CREVICE_BOUNCE + visibility);
        red += bounce * blocker.color[0] * (BOUNCE_AMBIENT + BOUNCE_KEY * KEY_RADIANCE[0]);
        green += bounce * blocker.color[1] * (BOUNCE_AMBIENT + BOUNCE_KEY * KEY_RADIANCE[1]);
        blue += bounce * blocker.color[2] * (BOUNCE_AMBIENT + BOUNCE_KEY * KEY_RADIANCE[2]);
      }
      open += weight * visibility;
      total += weight;
    }
    this.ambient[0] = red / total;
    this.ambient[1] = green / total;
    this.ambient[2] = blue / total;
    this.openness = open / total;
  }
}
