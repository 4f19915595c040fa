import { getRootState, type RootState, type ThreeElement } from '@react-three/fiber';
import type { EffectUse } from '@websplatter/core/effects';
import {
  SplatCloudObject as ObjectOfThree,
  type PickEvent,
  type SplatData,
  type SplatHit,
} from '@websplatter/three';
import type { Color, Object3D } from 'three';
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
 * off. Its `pickAt` uses the Canvas's renderer and camera, and it requests the frames that it needs.
 *
 * @example
 * function Garden() {
 *   const splats = useRef<SplatCloudObject>(null);
 *   useFrame(({ clock }) => {
 *     if (splats.current) splats.current.tint = [1, 0.5 + 0.5 * Math.sin(clock.elapsedTime), 0.5];
 *   });
 *   return <Splats ref={splats} src="/garden.ply" />;
 * }
 */
export class SplatCloudObject extends ObjectWithEffects {
  #tint: SplatColor | null = null;

  constructor(data: SplatData | null = null) {
    super(data);
    // react-three-fiber resets removed props to these values.
    for (const name of NAMES_OF_EFFECTS) Object.assign(this, { [name]: null });
    this.addEventListener('needsframe', () => rootStateOf(this)?.invalidate());
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
   * Returns the splat that contributes most to the pixel under a pointer, in the last frame; null if
   * there is none, or if it belongs to another cloud.
   *
   * @param event of react-three-fiber, React or the DOM.
   * @param renderer, camera default the Canvas's.
   * @throws InvalidArgumentError for an event without a place.
   * @example
   * <Splats
   *   ref={splats}
   *   src="/garden.ply"
   *   onClick={async (event) => console.log((await splats.current?.pickAt(event))?.row)}
   * />
   */
  override async pickAt(
    event: PickEvent,
    renderer?: WebGPURenderer,
    camera?: Camera,
  ): Promise<SplatHit | null> {
    const state = rootStateOf(this);
    const drawing = renderer ?? (state && (rendererOf(state) as WebGPURenderer));
    const seeing = camera ?? state?.camera;
    // Unmounted: without a Canvas there is no frame.
    return drawing && seeing ? super.pickAt(event, drawing, seeing) : null;
  }
}

/** The Canvas that an object is in, also as a part of a `<primitive>`, such as a glTF's scene. */
function rootStateOf(object: Object3D): RootState | undefined {
  for (let each: Object3D | null = object; each; each = each.parent) {
    const state = getRootState(each);
    if (state) return state;
  }
  return undefined;
}

declare module '@react-three/fiber' {
  interface ThreeElements {
    /** After `extend({ SplatCloudObject })`. */
    splatCloudObject: ThreeElement<typeof SplatCloudObject>;
  }
}
