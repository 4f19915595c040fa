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
 * Covers the viewport with a texture of its size, pixel on pixel.
 *
 * three builds one shader for the material and one set of bindings per kind of target and depth of nesting. It binds what
 * `show` has set when it draws the object, directly after `onBeforeRender`; a draw that was recorded before keeps its own
 * bind group. So one material serves all views as long as each draw is preceded by `show` or `showNothing`.
 */
abstract class ViewportMaterial extends NodeMaterial {
  /** The picture's pixel at the fragment. */
  protected readonly texel;
  readonly #nothing: Texture;
  readonly #picture;
  readonly #originPx = uniform(new Vector2());
  /** Pixels of the picture per pixel of the target: 0 shows its first everywhere. */
  readonly #scale = uniform(0);

  /** @param nothing a texture of one pixel that the material leaves out; of the pictures' sample type. */
  constructor(nothing: Texture) {
    super();
    nothing.needsUpdate = true;
    this.#nothing = nothing;
    this.#picture = texture(nothing);
    this.texel = this.#picture.load(ivec2(screenCoordinate.sub(this.#originPx).mul(this.#scale)));
    this.transparent = true;
    this.blending = NoBlending;
    this.fog = false;
    this.lights = false;
    // Another material in its place would fill the whole viewport.
    this.allowOverride = false;
    this.vertexNode = vec4(positionGeometry.xy, 0, 1);
    // Towards the camera, for targets that take normals.
    this.normalNode = vec3(0, 0, 1);
  }

  /** @param xPx, yPx top left of the viewport in the target. */
  show(picture: ExternalTexture, xPx: number, yPx: number): void {
    this.#picture.value = picture;
    this.#originPx.value.set(xPx, yPx);
    this.#scale.value = 1;
  }

  showNothing(): void {
    this.#picture.value = this.#nothing;
    this.#scale.value = 0;
  }

  override dispose(): void {
    super.dispose();
    this.#nothing.dispose();
  }

  /** Clipping planes cut meshes by their own position, and a triangle over the viewport has none that means anything. */
  override setupClipping(): ReturnType<NodeMaterial['setupClipping']> {
    // Where nothing clips three returns null, too; its declarations leave that out.
    return null as never;
  }

  override setupHardwareClipping(): void {}
}

/** Replaces the target's colour wherever the picture has some opacity, by exactly what the picture holds. */
export class ColorLayerMaterial extends ViewportMaterial {
  constructor() {
    super(new DataTexture(new Uint8Array(4), 1, 1));
    this.depthTest = false;
    this.depthWrite = false;
    this.colorNode = this.texel;
    this.maskNode = this.texel.a.greaterThan(0);
  }
}

/** Writes the picture's values as depth, where they are not negative and nothing is in front of them. */
export class DepthLayerMaterial extends ViewportMaterial {
  constructor() {
    super(new DataTexture(Float32Array.of(-1), 1, 1, RedFormat, FloatType));
    this.colorWrite = false;
    this.depthFunc = LessEqualDepth;
    this.depthNode = this.texel.r;
    this.maskNode = this.texel.r.greaterThanEqual(0);
  }
}
