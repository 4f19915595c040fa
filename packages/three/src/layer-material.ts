import { ivec2, positionGeometry, screenCoordinate, texture, uniform, vec3, vec4 } from 'three/tsl';
import {
  DataTexture,
  type ExternalTexture,
  FloatType,
  LessEqualDepth,
  NoBlending,
  NodeMaterial,
  RedFormat,
  type Texture,
  Vector2,
} from 'three/webgpu';

/**
 * Covers the viewport with an image of its size, pixel by pixel.
 *
 * three builds one shader for the material, and one set of bindings per kind of target and depth of nesting. When it draws
 * the object, directly after `onBeforeRender`, it binds the image that `show` has set; draws recorded before keep their own
 * bind groups. One material therefore serves all views, as long as `show` or `showNothing` precedes each draw.
 */
abstract class ViewportMaterial extends NodeMaterial {
  /** The image's pixel at the fragment. */
  protected readonly texel;
  readonly #nothing: Texture;
  readonly #image;
  readonly #originPx = uniform(new Vector2());
  /** Pixels of the image per pixel of the target; 0 shows the image's first pixel everywhere. */
  readonly #scale = uniform(0);

  /** @param nothing a texture of one pixel that the material does not draw, with the sample type of the images. */
  constructor(nothing: Texture) {
    super();
    nothing.needsUpdate = true;
    this.#nothing = nothing;
    this.#image = texture(nothing);
    this.texel = this.#image.load(ivec2(screenCoordinate.sub(this.#originPx).mul(this.#scale)));
    this.transparent = true;
    this.blending = NoBlending;
    this.fog = false;
    this.lights = false;
    // An override material would fill the whole viewport.
    this.allowOverride = false;
    this.vertexNode = vec4(positionGeometry.xy, 0, 1);
    // A normal towards the camera, for targets with normals.
    this.normalNode = vec3(0, 0, 1);
  }

  /** @param xPx, yPx top left of the viewport in the target. */
  show(image: ExternalTexture, xPx: number, yPx: number): void {
    this.#image.value = image;
    this.#originPx.value.set(xPx, yPx);
    this.#scale.value = 1;
  }

  showNothing(): void {
    this.#image.value = this.#nothing;
    this.#scale.value = 0;
  }

  override dispose(): void {
    super.dispose();
    this.#nothing.dispose();
  }

  /** Ignores clipping planes: they cut meshes by position, and the position of a triangle over the viewport means nothing. */
  override setupClipping(): ReturnType<NodeMaterial['setupClipping']> {
    // three, too, returns null if nothing clips; its type declarations omit that.
    return null as never;
  }

  override setupHardwareClipping(): void {}
}

/** Replaces the target's colour with the image's exact value wherever the image has some opacity. */
export class ColorLayerMaterial extends ViewportMaterial {
  constructor() {
    super(new DataTexture(new Uint8Array(4), 1, 1));
    this.depthTest = false;
    this.depthWrite = false;
    this.colorNode = this.texel;
    this.maskNode = this.texel.a.greaterThan(0);
  }
}

/** Writes the image's values as depth, except negative ones and those with something in front of them. */
export class DepthLayerMaterial extends ViewportMaterial {
  constructor() {
    super(new DataTexture(Float32Array.of(-1), 1, 1, RedFormat, FloatType));
    this.colorWrite = false;
    this.depthFunc = LessEqualDepth;
    this.depthNode = this.texel.r;
    this.maskNode = this.texel.r.greaterThanEqual(0);
  }
}
