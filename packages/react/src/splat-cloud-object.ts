import { getRootState, type ThreeElement } from '@react-three/fiber';
import type { EffectUse } from '@websplatter/core/effects';
import { SplatCloudObject as ObjectOfThree, type SplatData, type SplatHit } from '@websplatter/three';
import type { Color } from 'three';
import type { Camera, WebGPURenderer } from 'three/webgpu';
import {
  colorInEngine,
  NAMES_OF_EFFECTS,
  type NamedOptions,
  type SplatColor,
  usesOfOptions,
} from './effect-props.ts';
import { rendererOf } from './use-renderer.ts';

/** The base class with a property for each effect except `tint`, null at first. */
const ObjectWithEffects = ObjectOfThree as unknown as new (
  data?: SplatData | null,
) => ObjectOfThree & Omit<NamedOptions, 'tint'>;

/**
 * The object of a `<Splats>`: a SplatCloudObject of @websplatter/three with the effects of `<Splats>`
 * as properties, which may change in every frame: `ref.current.tint = 'orange'`. Null turns an effect
 * off. Its `pick` uses the Canvas's renderer and camera.
 *
 * @example
 * function Garden() {
 *   const splats = useRef<SplatCloudObject>(null);
 *   useFrame(({ clock }) => {
 *     if (splats.current) splats.current.tint = [1, 0.5 + 0.5 * Math.sin(clock.elapsedTime), 0.5];
 *   });
 *   return <Splats ref={splats} src="garden.ply" />;
 * }
 */
export class SplatCloudObject extends ObjectWithEffects {
  #tint: SplatColor | null = null;

  constructor(data: SplatData | null = null) {
    super(data);
    // react-three-fiber resets removed props to these values.
    for (const name of NAMES_OF_EFFECTS) Object.assign(this, { [name]: null });
  }

  /**
   * Multiplies every colour: see `EffectProps`. A Color is converted when it is set; the getter
   * returns red, green and blue, sRGB-encoded.
   */
  get tint(): SplatColor | null {
    return this.#tint;
  }

  set tint(color: SplatColor | null) {
    // react-three-fiber would copy the next colour into a Color that is kept here.
    this.#tint = (color as Color | null)?.isColor ? colorInEngine(color!) : color;
  }

  protected override ownEffects(): readonly EffectUse[] {
    const uses = usesOfOptions(this, (...number) => this.clamped(...number));
    return [...uses, ...super.ownEffects()];
  }

  override copy(source: this, recursive?: boolean): this {
    super.copy(source, recursive);
    for (const name of NAMES_OF_EFFECTS) Object.assign(this, { [name]: source[name] });
    return this;
  }

  /**
   * Returns the splat that contributes most to a pixel of the last frame from the Canvas's camera;
   * null if there is none, or if it belongs to another cloud.
   *
   * @param x, y CSS pixels from the canvas's top left, as `offsetX` and `offsetY` of its pointer
   *   events are.
   */
  override pick(x: number, y: number): Promise<SplatHit | null>;
  /** Picks from the last frame of any renderer and camera, in physical pixels. */
  override pick(renderer: WebGPURenderer, camera: Camera, xPx: number, yPx: number): Promise<SplatHit | null>;
  override pick(
    ...place: [number, number] | [WebGPURenderer, Camera, number, number]
  ): Promise<SplatHit | null> {
    if (place.length === 4) return super.pick(...place);
    const state = getRootState(this);
    // Unmounted: without a Canvas there is no frame.
    if (!state) return Promise.resolve(null);
    const renderer = rendererOf(state) as WebGPURenderer;
    const [xPx, yPx] = place.map((distance) => Math.floor(distance * renderer.getPixelRatio()));
    return super.pick(renderer, state.camera, xPx, yPx);
  }
}

declare module '@react-three/fiber' {
  interface ThreeElements {
    /** After `extend({ SplatCloudObject })`. */
    splatCloudObject: ThreeElement<typeof SplatCloudObject>;
  }
}
