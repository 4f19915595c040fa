import { DataTexture, FloatType, LessEqualDepth, RedFormat } from 'three/webgpu';
import { type Texel, ViewportMaterial } from './layer-material.ts';

/** Returns a depth image without splats. */
export const noDepth = () => new DataTexture(Float32Array.of(-1), 1, 1, RedFormat, FloatType);

/** Writes the image's values as depth, except negative values; the depth test hides farther ones. */
export class DepthLayerMaterial extends ViewportMaterial {
  constructor() {
    super(noDepth());
    this.colorWrite = false;
    this.depthFunc = LessEqualDepth;
  }

  override shade(texel: Texel): void {
    this.depthNode = texel.r;
    this.maskNode = texel.r.greaterThanEqual(0);
  }
}
