/** Bakes light into a splat: outgoing radiance over viewing directions, tone-mapped and fitted by harmonics. */
import type { ShDegree } from '@websplatter/core';
import {
  displayValue,
  highlightOvershoot,
  KEY_DIRECTION,
  KEY_RADIANCE,
  keyDisc,
  type Rgb,
  skyRadiance,
} from './lighting.ts';
import { clamp01, mix, smoothstep } from './noise.ts';
import type { OcclusionField } from './occlusion.ts';
import { FIT_DIRECTIONS, SH_C0, ShFit, shBasisSize } from './sh-fit.ts';

/** Material of a surface at one point. Linear colours. One object is reused for all points. */
export class Finish {
  /** Diffuse reflectance. */
  readonly albedo = new Float64Array(3);
  /** Mirror reflectance at normal incidence; 0.04 for glaze and skin, the metal's colour for metals. */
  readonly mirror = new Float64Array(3);
  /** 0: polished, 1: matte. */
  roughness = 0.6;
  /** Light that scatters under the skin: how far around the terminator the key light reaches, per channel, 0 to 1. */
  readonly scatter = new Float64Array(3);
  /** Share of light from behind that shines through. */
  readonly through = new Float64Array(3);
  /** Brightening at grazing angles by fibres. */
  sheen = 0;
  /** Occlusion by detail finer than the stand-ins: creases, gaps, weave. 1: none. */
  cavity = 1;
  /** Range that a splat's opacity is drawn from. */
  opacityLow = 0.82;
  opacityHigh = 0.995;
  /** Stretch of the splat along the grain: length over width, 1 for none. */
  grainAspect = 1;
  /** The grain's direction in the scene, of any length; only read where the aspect is above 1. */
  grainX = 1;
  grainZ = 0;
  /** Seen from both sides: harmonics are fitted over the whole sphere. */
  twoSided = false;

  /** Back to the defaults above, for the next point. */
  reset(): void {
    this.albedo.fill(0);
    this.mirror.fill(0);
    this.roughness = 0.6;
    this.scatter.fill(0);
    this.through.fill(0);
    this.sheen = 0;
    this.cavity = 1;
    this.opacityLow = 0.82;
    this.opacityHigh = 0.995;
    this.grainAspect = 1;
    this.twoSided = false;
  }

  setAlbedo(color: Rgb): void {
    this.albedo.set(color);
  }

  /** Albedo between two colours. */
  mixAlbedo(a: Rgb, b: Rgb, t: number): void {
    for (let k = 0; k < 3; k++) this.albedo[k] = mix(a[k], b[k], t);
  }

  /** Moves the albedo towards a colour. */
  blendAlbedo(color: Rgb, t: number): void {
    for (let k = 0; k < 3; k++) this.albedo[k] = mix(this.albedo[k], color[k], t);
  }

  scaleAlbedo(factor: number): void {
    for (let k = 0; k < 3; k++) this.albedo[k] *= factor;
  }

  /** A mirror reflectance without colour. */
  setMirror(reflectance: number): void {
    this.mirror.fill(reflectance);
  }
}

/** A coloured ball that reflections see: a neighbour, roughly. */
export interface ReflectedBall {
  readonly center: readonly [number, number, number];
  readonly radius: number;
  readonly color: Rgb;
  readonly owner: string;
}

/** The table top at y = 0, on which reflections going down land. */
interface ReflectedTable {
  readonly radius: number;
  readonly color: Rgb;
}

/** Reflections at and above this roughness are too blurred to show a neighbour. */
const ROUGHEST_REFLECTED_NEIGHBOUR = 0.2;
/** Light on a surface that a reflection shows, as a share of full sun and sky. */
const REFLECTED_LIGHT = 0.6;
/** Part of the key light's reflection that remains in shadow: the shadow is soft and the disc large. */
const SHADOWED_DISC = 0.12;
/** Ceiling of a single sample of radiance: keeps one splat's highlight from ringing across its whole sphere. */
const BRIGHTEST_SAMPLE = 12;

export class Shader {
  readonly field: OcclusionField;
  /** r, g, b per basis function; the last shading's result. */
  readonly coefficients: Float64Array;
  readonly #front: ShFit;
  readonly #both: ShFit;
  readonly #balls: readonly ReflectedBall[];
  readonly #table: ReflectedTable;
  readonly #samples = new Float64Array(3 * FIT_DIRECTIONS);
  readonly #diffuse = new Float64Array(3);
  readonly #incoming = new Float64Array(3);
  readonly #frame = new Float64Array(9);

  constructor(
    degree: ShDegree,
    field: OcclusionField,
    balls: readonly ReflectedBall[],
    table: ReflectedTable,
  ) {
    this.field = field;
    this.#front = new ShFit(degree, 'front');
    this.#both = new ShFit(degree, 'both');
    this.#balls = balls;
    this.#table = table;
    this.coefficients = new Float64Array(3 * shBasisSize(degree));
  }

  /** A colour that does not depend on the direction; linear. */
  setFlat(red: number, green: number, blue: number): void {
    this.coefficients.fill(0);
    this.coefficients[0] = (displayValue(red) - 0.5) / SH_C0;
    this.coefficients[1] = (displayValue(green) - 0.5) / SH_C0;
    this.coefficients[2] = (displayValue(blue) - 0.5) / SH_C0;
  }

  /**
   * Shades a point of a surface. `frame` holds the splat's axes, the third of them the shading normal.
   * `owner` names the object, which does not occlude itself.
   */
  shadeSurface(x: number, y: number, z: number, frame: Float64Array, finish: Finish, owner: string): void {
    const nx = frame[6];
    const ny = frame[7];
    const nz = frame[8];
    const { field } = this;
    const facing = nx * KEY_DIRECTION[0] + ny * KEY_DIRECTION[1] + nz * KEY_DIRECTION[2];
    const scatters = finish.scatter[0] > 0 || finish.through[0] > 0;
    const shadow = facing > 0 || scatters ? field.keyVisibility(x, y, z, owner) : 0;
    field.gatherAmbient(x, y, z, nx, ny, nz, owner);
    const { ambient } = field;
    const diffuse = this.#diffuse;
    for (let k = 0; k < 3; k++) {
      const wrap = finish.scatter[k];
      // Normalised so that wrapping moves light around the terminator without adding any.
      const direct = wrap > 0 ? Math.max(0, (facing + wrap) / (1 + wrap)) ** (1 + wrap) : Math.max(0, facing);
      const behind = finish.through[k] * Math.max(0, 0.35 - 0.65 * facing);
      diffuse[k] =
        finish.albedo[k] *
        (KEY_RADIANCE[k] * shadow * (direct * (0.5 + 0.5 * finish.cavity) + behind) +
          ambient[k] * finish.cavity);
    }
    if (finish.mirror[1] === 0 && finish.sheen === 0) {
      this.setFlat(diffuse[0], diffuse[1], diffuse[2]);
      return;
    }
    this.#fitGlossy(x, y, z, frame, finish, owner, shadow, field.openness);
  }

  #fitGlossy(
    x: number,
    y: number,
    z: number,
    frame: Float64Array,
    finish: Finish,
    owner: string,
    shadow: number,
    openness: number,
  ): void {
    const fit = finish.twoSided ? this.#both : this.#front;
    const { views } = fit;
    const { mirror, roughness } = finish;
    const samples = this.#samples;
    const diffuse = this.#diffuse;
    const incoming = this.#incoming;
    const exposure = Math.sqrt(openness) * (0.4 + 0.6 * finish.cavity);
    const disc = SHADOWED_DISC * openness + (1 - SHADOWED_DISC) * shadow;
    const grazingGain = (1 - roughness) ** 2;
    for (let i = 0; i < FIT_DIRECTIONS; i++) {
      const lx = views[3 * i];
      const ly = views[3 * i + 1];
      // A thin sheet's back reflects as its front does.
      const lz = finish.twoSided ? Math.abs(views[3 * i + 2]) : Math.max(views[3 * i + 2], 0);
      const flip = finish.twoSided && views[3 * i + 2] < 0 ? -1 : 1;
      // The reflected direction in the local frame is (-lx, -ly, lz): only the normal component keeps its sign.
      const rz = lz * flip;
      const rx = -lx * frame[0] - ly * frame[3] + rz * frame[6];
      const ry = -lx * frame[1] - ly * frame[4] + rz * frame[7];
      const rz3 = -lx * frame[2] - ly * frame[5] + rz * frame[8];
      this.#reflectedRadiance(x, y, z, rx, ry, rz3, roughness, owner, disc);
      const grazing = 1 - lz;
      const grazing2 = grazing * grazing;
      const fresnel = grazing2 * grazing2 * grazing * grazingGain;
      const fibre = finish.sheen * grazing2 * grazing * openness;
      for (let k = 0; k < 3; k++) {
        const reflectance = mirror[k] + (1 - mirror[k]) * fresnel;
        const radiance =
          diffuse[k] * (1 - reflectance) + fibre * diffuse[k] + incoming[k] * reflectance * exposure;
        const limited = Math.min(radiance, BRIGHTEST_SAMPLE);
        samples[3 * i + k] = displayValue(limited) + highlightOvershoot(limited);
      }
    }
    fit.fit(samples, frame, this.coefficients);
  }

  /** Writes the radiance that a reflection receives along a direction into `#incoming`. */
  #reflectedRadiance(
    x: number,
    y: number,
    z: number,
    dx: number,
    dy: number,
    dz: number,
    roughness: number,
    owner: string,
    disc: number,
  ): void {
    const incoming = this.#incoming;
    skyRadiance(dx, dy, dz, roughness, incoming);
    const key = keyDisc(dx, dy, dz, roughness) * disc;
    for (let k = 0; k < 3; k++) incoming[k] += key * KEY_RADIANCE[k];
    if (dy < 0 && y > 0) {
      const reach = y / Math.max(-dy, 0.02);
      const hitX = x + dx * reach;
      const hitZ = z + dz * reach;
      const onTable =
        smoothstep(0, 0.15 + 0.3 * roughness, -dy) *
        (1 - smoothstep(this.#table.radius * 0.85, this.#table.radius * 1.1, Math.hypot(hitX, hitZ)));
      // Right under an object its table lies in its own shade.
      const light = REFLECTED_LIGHT * (0.25 + 0.75 * clamp01(reach / 0.06));
      for (let k = 0; k < 3; k++) {
        incoming[k] = mix(incoming[k], this.#table.color[k] * KEY_RADIANCE[k] * light, onTable);
      }
    }
    if (roughness >= ROUGHEST_REFLECTED_NEIGHBOUR) return;
    for (const ball of this.#balls) {
      if (ball.owner === owner) continue;
      const cx = ball.center[0] - x;
      const cy = ball.center[1] - y;
      const cz = ball.center[2] - z;
      const along = cx * dx + cy * dy + cz * dz;
      if (along <= 0) continue;
      const miss = Math.sqrt(Math.max(0, cx * cx + cy * cy + cz * cz - along * along));
      if (miss > 1.3 * ball.radius) continue;
      const cover = 1 - smoothstep(0.75 * ball.radius, 1.3 * ball.radius, miss);
      for (let k = 0; k < 3; k++) {
        incoming[k] = mix(incoming[k], ball.color[k] * KEY_RADIANCE[k] * REFLECTED_LIGHT, cover);
      }
    }
  }

  /**
   * Shades a fibre along the unit vector (tx, ty, tz): diffuse light by the angle to the fibre, light shining through
   * when looked at against the sun, and the ring-shaped highlight of a cylinder (Kajiya and Kay).
   * @param exposure 0 deep inside a tuft to 1 on its outside
   */
  shadeFibre(
    tx: number,
    ty: number,
    tz: number,
    color: Rgb,
    gloss: number,
    shadow: number,
    exposure: number,
  ): void {
    const alongKey = tx * KEY_DIRECTION[0] + ty * KEY_DIRECTION[1] + tz * KEY_DIRECTION[2];
    const acrossKey = Math.sqrt(Math.max(0, 1 - alongKey * alongKey));
    const lit = shadow * exposure;
    const samples = this.#samples;
    const { views } = this.#both;
    const frame = this.#frame;
    // Fibres take the scene's own axes: nothing about them is one-sided.
    frame.fill(0);
    frame[0] = 1;
    frame[4] = 1;
    frame[8] = 1;
    const skyShare = 0.5 + 0.5 * exposure;
    for (let i = 0; i < FIT_DIRECTIONS; i++) {
      const vx = views[3 * i];
      const vy = views[3 * i + 1];
      const vz = views[3 * i + 2];
      const alongView = tx * vx + ty * vy + tz * vz;
      const acrossView = Math.sqrt(Math.max(0, 1 - alongView * alongView));
      const highlight = Math.max(0, acrossKey * acrossView - alongKey * alongView);
      const highlight4 = highlight ** 4;
      const towardsKey = vx * KEY_DIRECTION[0] + vy * KEY_DIRECTION[1] + vz * KEY_DIRECTION[2];
      const against = Math.max(0, -towardsKey);
      for (let k = 0; k < 3; k++) {
        const scattered = color[k] * (KEY_RADIANCE[k] * lit * acrossKey * (0.5 + 0.55 * against * against));
        const ambient = color[k] * skyShare * (0.42 - 0.03 * k);
        samples[3 * i + k] = displayValue(
          scattered + ambient + gloss * highlight4 * highlight4 * KEY_RADIANCE[k] * lit,
        );
      }
    }
    this.#both.fit(samples, frame, this.coefficients);
  }
}
