import type { CloudInstance, EmbeddedImage, EmbeddedView } from '@websplatter/core';
import { type Camera, ExternalTexture, FloatType, UnsignedByteType } from 'three/webgpu';
import type { LayerCloud } from './layer-cloud.ts';

/** Draws of a layer after which a view that had no part in them is freed: some seconds of frames with several views. */
const MAX_IDLE_DRAWS = 600;

/** What a layer keeps for one renderer's pictures from one camera in one target. */
export class LayerView {
  readonly embedded: EmbeddedView;
  /** The last picture as three binds it; null before the first. */
  color: ExternalTexture | null = null;
  /** Its depth; null where it has none. */
  depth: ExternalTexture | null = null;
  /** What the embedded view has drawn last, in its order. */
  clouds: ReadonlyMap<LayerCloud, CloudInstance> = new Map();
  /** Top left of the viewport that the picture belongs to. */
  xPx = 0;
  yPx = 0;
  /** Number of the layer's draw that used it last. */
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

/** Of one renderer and one camera. */
interface CameraViews {
  readonly byTarget: WeakMap<object, LayerView>;
  latest: LayerView | null;
}

/**
 * The views of a layer, by renderer, camera and target: a render nested in another, a mirror's for example, must not
 * disturb the one around it.
 */
export class LayerViews {
  readonly #byRenderer = new WeakMap<object, WeakMap<Camera, CameraViews>>();
  readonly #all = new Set<LayerView>();
  #draws = 0;

  /** The view for a draw, made by `create` where there is none; frees those that have long been idle. */
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

  /** The view that was drawn last of those of `renderer` from `camera`. */
  latest(renderer: object, camera: Camera): LayerView | null {
    const { latest } = this.#of(renderer, camera);
    return latest && this.#all.has(latest) ? latest : null;
  }

  /** The view that was drawn last of those whose picture has `cloud`. */
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

/** `old` where it wraps `texture` already: three keeps a texture's views, so that another one needs another object. */
function wrapping(old: ExternalTexture | null, texture: GPUTexture): ExternalTexture {
  if (old?.sourceTexture === texture) return old;
  old?.dispose();
  const wrapper = new ExternalTexture(texture);
  // Decides whether three binds it as filterable.
  wrapper.type = texture.format === 'r32float' ? FloatType : UnsignedByteType;
  return wrapper;
}
