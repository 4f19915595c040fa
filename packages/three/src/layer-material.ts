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

/** An image to show, and the top left of its viewport in the target. */
export interface ShownImage {
  readonly color: ExternalTexture | null;
  readonly depth: ExternalTexture | null;
  readonly xPx: number;
  readonly yPx: number;
}

/** A place for an image in a material, which has one for each camera that draws at once. */
export type ImageSlot = ReturnType<typeof imageSlot>;

/**
 * Makes a place for the image of `kind` of what is shown.
 *
 * @param nothing a texture of one pixel, which shaders do not draw: of its own, since three binds nodes that begin with the same
 *   texture only once.
 */
export function imageSlot(nothing: Texture, kind: 'color' | 'depth') {
  nothing.needsUpdate = true;
  const image = texture(nothing);
  const originPx = uniform(new Vector2());
  /** Pixels of the image per pixel of the target; 0 shows the image's first pixel everywhere. */
  const scale = uniform(0);
  return {
    nothing,
    kind,
    /** The image's pixel at the fragment. */
    texel: image.load(ivec2(screenCoordinate.sub(originPx).mul(scale))),
    show(shown: ShownImage | null | undefined) {
      image.value = shown?.[kind] ?? nothing;
      scale.value = Number(image.value !== nothing);
      if (shown) originPx.value.set(shown.xPx, shown.yPx);
    },
  };
}

/** The pixel of an image, in a shader. */
export type Texel = ImageSlot['texel'];

/**
 * Covers the viewport with an image of its size, pixel by pixel.
 *
 * three builds one shader for the material, and one set of bindings per kind of target and depth of nesting. When it draws
 * the object, directly after `onBeforeRender`, it binds the images that the slots have; draws recorded before keep their own
 * bind groups. One material therefore serves all views, as long as every slot shows an image or nothing before each draw.
 */
export abstract class ViewportMaterial extends NodeMaterial {
  /** By the camera's index; only one, until several cameras draw at once. */
  readonly slots: ImageSlot[];

  constructor(slot: ImageSlot) {
    super();
    this.slots = [slot];
    this.transparent = true;
    this.blending = NoBlending;
    this.fog = false;
    this.lights = false;
    // An override material would fill the whole viewport.
    this.allowOverride = false;
    this.vertexNode = vec4(positionGeometry.xy, 0, 1);
    // A normal towards the camera, for targets with normals.
    this.normalNode = vec3(0, 0, 1);
    this.shade(slot.texel);
  }

  /** Makes the material draw `texel`. */
  abstract shade(texel: Texel): void;

  /** @param shown by the camera's index. */
  show(shown: readonly (ShownImage | null)[]): void {
    this.slots.forEach((slot, i) => {
      slot.show(shown[i]);
    });
  }

  override dispose(): void {
    super.dispose();
    for (const { nothing } of this.slots) nothing.dispose();
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
    super(imageSlot(new DataTexture(new Uint8Array(4), 1, 1), 'color'));
    this.depthTest = false;
    this.depthWrite = false;
  }

  override shade(texel: Texel): void {
    this.colorNode = texel;
    this.maskNode = texel.a.greaterThan(0);
  }
}

/** Writes the image's values as depth, except negative ones and those with something in front of them. */
export class DepthLayerMaterial extends ViewportMaterial {
  constructor() {
    super(imageSlot(new DataTexture(Float32Array.of(-1), 1, 1, RedFormat, FloatType), 'depth'));
    this.colorWrite = false;
    this.depthFunc = LessEqualDepth;
  }

  override shade(texel: Texel): void {
    this.depthNode = texel.r;
    this.maskNode = texel.r.greaterThanEqual(0);
  }
}
