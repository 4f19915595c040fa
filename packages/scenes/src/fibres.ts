/** Threads, hairs and blades as chains of long thin splats. */
import type { Rgb } from './lighting.ts';
import { type Studio, writeFrame } from './part.ts';

/** A bundle of fibres, each a curve from t = 0 (root) to t = 1 (tip). */
interface FibreBundle {
  /** Splats along one fibre. */
  readonly segments: number;
  /** Standard deviation across a fibre at its root, in metres, in the full scene; tips are half of it. */
  readonly radius: number;
  /** Whether smaller scenes' fewer fibres are wider, to fill the same tuft; true where absent. */
  readonly widens?: boolean;
  readonly color: Rgb | ((fibre: number, t: number, out: Float64Array) => void);
  /** Strength of the highlight along the fibre. */
  readonly gloss: number;
  /** Lowest and highest opacity. */
  readonly opacity: readonly [number, number];
  readonly owner: string;
  /** Writes the position of a fibre at `t`, in metres; no two `t` may give the same place. */
  place(fibre: number, t: number, out: Float64Array): void;
  /** How exposed the fibre is to light, 0 deep in a tuft to 1; 1 where absent. */
  exposure?(fibre: number, t: number): number;
}

/** Standard deviation of a segment along the fibre over its length: neighbours meet at half their height. */
const SEGMENT_OVERLAP = 0.42;
/** No needle is longer than this many times its width: the range that trained scenes show. */
const LARGEST_ASPECT = 300;

/** Adds `count` splats, fibre after fibre; the last fibre may lack its tip. */
export function emitFibres(count: number, studio: Studio, bundle: FibreBundle): void {
  const { builder, shader, prng } = studio;
  const from = new Float64Array(3);
  const to = new Float64Array(3);
  const color = new Float64Array(3);
  const frame = new Float64Array(9);
  const scales = new Float64Array(3);
  const widening = bundle.widens === false ? 1 : studio.fibreWidening;
  if (typeof bundle.color !== 'function') color.set(bundle.color);
  for (let i = 0; i < count; i++) {
    const fibre = Math.floor(i / bundle.segments);
    const segment = i % bundle.segments;
    const t = (segment + 0.5) / bundle.segments;
    bundle.place(fibre, segment / bundle.segments, from);
    bundle.place(fibre, (segment + 1) / bundle.segments, to);
    if (typeof bundle.color === 'function') bundle.color(fibre, t, color);
    let dx = to[0] - from[0];
    let dy = to[1] - from[1];
    let dz = to[2] - from[2];
    const length = Math.hypot(dx, dy, dz);
    dx /= length;
    dy /= length;
    dz /= length;
    const x = (from[0] + to[0]) / 2;
    const y = (from[1] + to[1]) / 2;
    const z = (from[2] + to[2]) / 2;
    // The splat's z axis: at right angles to the fibre, by the scene axis that is least along it.
    const flat = Math.abs(dy) < 0.9 ? Math.hypot(dx, dz) : Math.hypot(dy, dz);
    if (Math.abs(dy) < 0.9) writeFrame(dx, dy, dz, dz / flat, 0, -dx / flat, frame);
    else writeFrame(dx, dy, dz, 0, dz / flat, -dy / flat, frame);
    const along = SEGMENT_OVERLAP * length * Math.exp(0.08 * prng.gaussian());
    const taper = 1 - 0.5 * t;
    const radius = bundle.radius * widening * taper * Math.exp(0.2 * prng.gaussian());
    scales[0] = along;
    scales[1] = Math.min(Math.max(radius, along / LARGEST_ASPECT), along);
    scales[2] = scales[1] * prng.range(0.6, 1);
    const opacity = prng.range(bundle.opacity[0], bundle.opacity[1]);
    const shadow = shader.field.keyVisibility(x, y, z, bundle.owner);
    const exposure = bundle.exposure === undefined ? 1 : bundle.exposure(fibre, t);
    shader.shadeFibre(dx, dy, dz, [color[0], color[1], color[2]], bundle.gloss, shadow, exposure);
    builder.add(x, y, z, frame, scales, opacity, shader.coefficients);
  }
}
