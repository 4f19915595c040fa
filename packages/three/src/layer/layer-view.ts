import type { EmbeddedImage, EmbeddedView } from '@websplatter/core';
import { type Camera, ExternalTexture, FloatType, UnsignedByteType } from 'three/webgpu';
import type { DrawnCloud, LayerCloud } from './layer-cloud.ts';

/** Draws of a layer after which an unused view is freed: some seconds of frames with several views. */
const MAX_IDLE_DRAWS = 600;

/** Renderer, camera and target of a view. */
interface ViewPlace {
  readonly renderer: object;
  readonly camera: Camera;
  readonly target: object;
}

/** State that a layer keeps for one renderer, camera and target. */
export class LayerView {
  readonly place: ViewPlace;
  readonly embedded: EmbeddedView;
  /** The last image in a texture of three's; null before the first. */
  color: ExternalTexture | null = null;
  /** Depth of the last image; null if it has none. */
  depth: ExternalTexture | null = null;
  /** State kept for the view's outputs; null before it is needed. */
  outputs: { destroy(): void } | null = null;
  /** Clouds of the embedded view's last frame, in its order. */
  clouds: ReadonlyMap<LayerCloud, DrawnCloud> = new Map();
  /** Top left of the viewport that the image belongs to. */
  xPx = 0;
  yPx = 0;
  /** Number of the layer's draw that used the view last. */
  usedAt = 0;

  constructor(place: ViewPlace, embedded: EmbeddedView) {
    this.place = place;
    this.embedded = embedded;
  }

  show({ color, depth }: EmbeddedImage, { xPx, yPx }: Pick<LayerView, 'xPx' | 'yPx'>): void {
    this.color = wrapping(this.color, color);
    if (!depth) this.depth?.dispose();
    this.depth = depth && wrapping(this.depth, depth);
    this.xPx = xPx;
    this.yPx = yPx;
  }

  destroy(): void {
    this.color?.dispose();
    this.depth?.dispose();
    this.outputs?.destroy();
    this.embedded.destroy();
  }
}

/**
 * The views of a layer, by renderer, camera and target: a nested render, such as a mirror's, must
 * not disturb the one around it.
 */
export class LayerViews {
  /** Views of the last frames, the most recently used at the end. */
  readonly #all = new Set<LayerView>();
  #draws = 0;

  /** Returns the view for a draw, made by `create` if there is none. Frees views that are long unused. */
  use(renderer: object, camera: Camera, target: object, create: () => EmbeddedView): LayerView {
    const place = { renderer, camera, target };
    const view = this.latest(renderer, camera, target) ?? new LayerView(place, create());
    this.#all.delete(view);
    this.#all.add(view);
    view.usedAt = ++this.#draws;
    this.#free((idle) => this.#draws - idle.usedAt > MAX_IDLE_DRAWS);
    return view;
  }

  /** Returns the view that `renderer` drew last from `camera` (to `target`, if given), or null. */
  latest(renderer: object, camera: Camera, target?: object): LayerView | null {
    return this.#latest(
      ({ place }) =>
        place.camera === camera && place.renderer === renderer && (!target || place.target === target),
    );
  }

  /** Returns the view whose last frame has `cloud` and was drawn last, or null. */
  latestWith(cloud: LayerCloud): LayerView | null {
    return this.#latest(({ clouds }) => clouds.has(cloud));
  }

  destroyAll(): void {
    this.#free(() => true);
  }

  #latest(isWanted: (view: LayerView) => boolean): LayerView | null {
    return [...this.#all].findLast(isWanted) ?? null;
  }

  #free(isIdle: (view: LayerView) => boolean): void {
    for (const view of this.#all) {
      if (!isIdle(view)) continue;
      this.#all.delete(view);
      view.destroy();
    }
  }
}

/**
 * Returns `old` if it wraps `texture`; if not, a new object, because three keeps the views of a
 * texture with its object.
 */
function wrapping(old: ExternalTexture | null, texture: GPUTexture): ExternalTexture {
  if (old?.sourceTexture === texture) return old;
  old?.dispose();
  const wrapper = new ExternalTexture(texture);
  // The type decides whether three binds the texture as filterable.
  wrapper.type = texture.format === 'r32float' ? FloatType : UnsignedByteType;
  return wrapper;
}
