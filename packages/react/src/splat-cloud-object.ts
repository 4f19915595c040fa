import { getRootState, type RootState, type ThreeElement } from '@react-three/fiber';
import type { PickEvent, SplatData, SplatHit } from '@websplatter/three';
import type { Object3D } from 'three';
import type { Camera, WebGPURenderer } from 'three/webgpu';
import { ObjectWithEffects } from './effect-props.ts';
import { rendererOf } from './use-renderer.ts';

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
  constructor(data: SplatData | null = null) {
    super(data);
    this.addEventListener('needsframe', () => rootStateOf(this)?.invalidate());
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
