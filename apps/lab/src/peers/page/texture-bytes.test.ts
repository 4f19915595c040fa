import { expect, test } from 'vitest';
import { textureBytes } from './texture-bytes.ts';

function texture(fields: Partial<GPUTexture>): GPUTexture {
  const plain = { width: 1, height: 1, depthOrArrayLayers: 1, mipLevelCount: 1, sampleCount: 1 };
  return { ...plain, dimension: '2d', ...fields } as GPUTexture;
}

test.each<[GPUTextureFormat, number]>([
  ['rgba8unorm', 4],
  ['bgra8unorm-srgb', 4],
  ['rgba16float', 8],
  ['rg32uint', 8],
  ['r8snorm', 1],
  ['rg11b10ufloat', 4],
  ['depth24plus-stencil8', 4],
  ['depth32float', 4],
  ['depth32float-stencil8', 8],
  ['depth16unorm', 2],
  ['bc1-rgba-unorm', 0.5],
  ['astc-4x4-unorm', 1],
])('a texel of %s takes %d bytes', (format, bytes) => {
  expect(textureBytes(texture({ format }))).toBe(bytes);
});

test('samples, layers and levels count, and depth halves from level to level only in three dimensions', () => {
  const layered = texture({
    format: 'r8unorm',
    width: 4,
    height: 2,
    depthOrArrayLayers: 3,
    mipLevelCount: 3,
  });
  expect(textureBytes(layered)).toBe(3 * (8 + 2 + 1));
  const solid = texture({ ...layered, dimension: '3d', depthOrArrayLayers: 4, mipLevelCount: 2 });
  expect(textureBytes(solid)).toBe(4 * 2 * 4 + 2 * 1 * 2);
  expect(textureBytes(texture({ format: 'rgba8unorm', width: 2, sampleCount: 4 }))).toBe(32);
});
