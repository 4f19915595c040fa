import type { CloudInstance, EmbeddedImage, EmbeddedView } from '@websplatter/core';
import { type Camera, ExternalTexture, FloatType, UnsignedByteType } from 'three/webgpu';
import type { LayerCloud } from './layer-cloud.ts';

/** Number of a layer's draws after which a view without one of them is freed: some seconds of frames with several views. */
const MAX_IDLE_DRAWS = 600;

/** State that a layer keeps for one renderer, camera and target. */
export class LayerView {
  readonly embedded: EmbeddedView;
  /** The last image in a texture of three's; null before the first. */
  color: ExternalTexture | null = null;
  /** Depth of the last image; null if it has none. */
  depth: ExternalTexture | null = null;
  /** Clouds of the embedded view's last frame, in its order. */
  clouds: ReadonlyMap<LayerCloud, CloudInstance> = new Map();
  /** Top left of the viewport that the image belongs to. */
  xPx = 0;
  yPx = 0;
  /** Number of the layer's draw that used the view last. */
  usedAt = 0;

  constructor(embedded: EmbeddedView) {
    this.embedded = embedded;
  }

  show({ color, depth }: EmbeddedImage, xPx: number, yPx: number): void {
    this.color = wrapping(this.color, color);
    if (!depth) this.depth?.dispose();
    this.depth = depth && wrapping(this.depth, depth);
    this.xPx = xPx;
    this.yPx = yPx;
  }

  destroy(): void {
    this.color?.dispose();
    this.depth?.dispose();
    this.embedded.destroy();
  }
}

/** Views of one renderer and one camera. */
interface CameraViews {
  readonly byTarget: WeakMap<object, LayerView>;
  latest: LayerView | null;
}

/**
 * The views of a layer, by renderer, camera and target: a nested render, such as a mirror's, must not disturb the one around
 * it.
 */
export class LayerViews {
  readonly #byRenderer = new WeakMap<object, WeakMap<Camera, CameraViews>>();
  readonly #all = new Set<LayerView>();
  #draws = 0;

  /** Returns the view for a draw, made by `create` if there is none. Frees views that have long been idle. */
  use(renderer: object, camera: Camera, target: object, create: () => EmbeddedView): LayerView {
    const views = this.#of(renderer, camera);
    let view = views.byTarget.get(target);
    if (!view || !this.#all.has(view)) {
      view = new LayerView(create());
      views.byTarget.set(target, view);
      this.#all.add(view);
    }
    views.latest = view;
    view.usedAt = ++this.#draws;
    this.#free((idle) => this.#draws - idle.usedAt > MAX_IDLE_DRAWS);
    return view;
  }

  /** Returns the view that `renderer` drew last from `camera`, or null. */
  latest(renderer: object, camera: Camera): LayerView | null {
    const { latest } = this.#of(renderer, camera);
    return latest && this.#all.has(latest) ? latest : null;
  }

  /** Returns the view whose last frame has `cloud` and was drawn last, or null. */
  latestWith(cloud: LayerCloud): LayerView | null {
    const views = [...this.#all].filter(({ clouds }) => clouds.has(cloud));
    return views.sort((a, b) => b.usedAt - a.usedAt)[0] ?? null;
  }

  destroyAll(): void {
    this.#free(() => true);
  }

  #of(renderer: object, camera: Camera): CameraViews {
    let byCamera = this.#byRenderer.get(renderer);
    if (!byCamera) {
      byCamera = new WeakMap();
      this.#byRenderer.set(renderer, byCamera);
    }
    let views = byCamera.get(camera);
    if (!views) {
      views = { byTarget: new WeakMap(), latest: null };
      byCamera.set(camera, views);
    }
    return views;
  }

  #free(isIdle: (view: LayerView) => boolean): void {
    for (const view of this.#all) {
      if (!isIdle(view)) continue;
      this.#all.delete(view);
      view.destroy();
    }
  }
}

/** Returns `old` if it wraps `texture`; if not, a new object, because three keeps the views of a texture with its object. */
function wrapping(old: ExternalTexture | null, texture: GPUTexture): ExternalTexture {
  if (old?.sourceTexture === texture) return old;
  old?.dispose();
  const wrapper = new ExternalTexture(texture);
  // The type decides whether three binds the texture as filterable.
  wrapper.type = texture.format === 'r32float' ? FloatType : UnsignedByteType;
  return wrapper;
}
