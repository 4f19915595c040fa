import {
  float,
  ivec2,
  screenCoordinate,
  select,
  texture,
  uint,
  uniform,
  vec3,
  vec4,
  vertexIndex,
} from 'three/tsl';
import {
  DataTexture,
  type ExternalTexture,
  NoBlending,
  NodeMaterial,
  type Texture,
  Vector2,
} from 'three/webgpu';

/** Images to show, and the top left of their viewport in the target. */
export interface ShownImages {
  readonly color: ExternalTexture | null;
  readonly depth: ExternalTexture | null;
  readonly xPx: number;
  readonly yPx: number;
}

/**
 * An image in the viewport, of its size, as a node.
 *
 * When three draws an object, directly after `onBeforeRender`, it binds the image that `show` has
 * set; draws recorded before keep their own bind groups. One node therefore serves all views, as
 * long as `show` precedes each draw.
 */
export class ViewportImage {
  /** The image's pixel at the fragment; the pixel of `nothing` if no image is set. */
  readonly texel;
  readonly nothing: Texture;
  readonly #image;
  readonly #originPx = uniform(new Vector2());
  /** Pixels of the image per pixel of the target; 0 shows the image's first pixel everywhere. */
  readonly #scale = uniform(0);

  /**
   * @param nothing a texture of one pixel, with the sample type of the images. Do not share it: three
   *   binds nodes that begin with the same texture only once.
   */
  constructor(nothing: Texture) {
    nothing.needsUpdate = true;
    this.nothing = nothing;
    this.#image = texture(nothing);
    this.texel = this.#image.load(ivec2(screenCoordinate.sub(this.#originPx).mul(this.#scale)));
  }

  /** @param image to show with its top left at `xPx`, `yPx` of the target; null: no image. */
  show(image?: Texture | null, xPx = 0, yPx = 0): void {
    this.#image.value = image ?? this.nothing;
    this.#originPx.value.set(xPx, yPx);
    this.#scale.value = Number(!!image);
  }

  dispose(): void {
    this.nothing.dispose();
  }
}

/** The pixel of an image, in a shader. */
export type Texel = ViewportImage['texel'];

/**
 * Covers the viewport with an image of its size, pixel by pixel. three builds one shader for the
 * material, and one set of bindings per kind of target and depth of nesting.
 */
export abstract class ViewportMaterial extends NodeMaterial {
  /** By the camera's index; only one, until several cameras draw at once. */
  readonly images: ViewportImage[];

  /** @param nothing an undrawn texture of one pixel, with the sample type of the images. */
  constructor(nothing: Texture) {
    super();
    this.images = [new ViewportImage(nothing)];
    this.transparent = true;
    this.blending = NoBlending;
    this.fog = false;
    this.lights = false;
    // An override material would fill the whole viewport.
    this.allowOverride = false;
    const cornerAt = (vertex: number) => select(vertexIndex.equal(uint(vertex)), float(3), float(-1));
    this.vertexNode = vec4(cornerAt(1), cornerAt(2), 0, 1);
    // A normal towards the camera, for targets with normals.
    this.normalNode = vec3(0, 0, 1);
    this.shade(this.images[0].texel);
  }

  /** Makes the material draw `texel`. */
  abstract shade(texel: Texel): void;

  /** @param shown by the camera's index. */
  show(shown: readonly (ShownImages | null)[], kind: 'color' | 'depth'): void {
    this.images.forEach((image, i) => {
      const of = shown[i];
      image.show(of?.[kind], of?.xPx, of?.yPx);
    });
  }

  override dispose(): void {
    super.dispose();
    for (const image of this.images) image.dispose();
  }

  /** Ignores clipping planes, which cut by position: a triangle over the viewport has none. */
  override setupClipping(): ReturnType<NodeMaterial['setupClipping']> {
    // three, too, returns null if nothing clips; its type declarations omit that.
    return null as never;
  }

  override setupHardwareClipping(): void {}
}

/** Replaces the target's colour with the image's exact value where the image has opacity. */
export class ColorLayerMaterial extends ViewportMaterial {
  constructor() {
    super(new DataTexture(new Uint8Array(4), 1, 1));
    this.depthTest = false;
    this.depthWrite = false;
  }

  override shade(texel: Texel): void {
    this.colorNode = texel;
    this.maskNode = texel.a.greaterThan(0);
  }
}
