/** Channels and bits of uncompressed formats, as their names begin. */
const PLAIN_FORMAT = /^(r|rg|rgba|bgra)(8|16|32)/;
const OTHER_FORMATS: readonly (readonly [RegExp, bytesPerPixel: number])[] = [
  [/^(rgb10a2|rg11b10|rgb9e5|depth24plus|depth32float$)/, 4],
  [/^depth32float-stencil8/, 8],
  [/^depth16/, 2],
  [/^stencil8/, 1],
  [/^(bc1|bc4|etc2-rgb8|eac-r11)/, 0.5],
];

/** Bytes that a texture needs at least; drivers may add padding. */
export function textureBytes(texture: GPUTexture): number {
  const pixelBytes = bytesPerPixel(texture.format) * texture.sampleCount;
  let bytes = 0;
  for (let level = 0; level < texture.mipLevelCount; level++) {
    const [width, height, depth] = [
      texture.width,
      texture.height,
      texture.dimension === '3d' ? texture.depthOrArrayLayers : 1,
    ].map((size) => Math.max(1, size >> level));
    bytes += width * height * depth * pixelBytes;
  }
  return texture.dimension === '3d' ? bytes : bytes * texture.depthOrArrayLayers;
}

function bytesPerPixel(format: GPUTextureFormat): number {
  const [, channels, bits] = PLAIN_FORMAT.exec(format) ?? [];
  if (channels) return (channels.length * Number(bits)) / 8;
  // Other compressed formats take 16 bytes per block of 4×4.
  return OTHER_FORMATS.find(([pattern]) => pattern.test(format))?.[1] ?? 1;
}

type Format = keyof WebGL2RenderingContext & Uppercase<string>;

const WEBGL_FORMATS: Readonly<Record<number, readonly Format[]>> = {
  16: ['RGBA32F', 'RGBA32UI', 'RGBA32I'],
  12: ['RGB32F', 'RGB32UI', 'RGB32I'],
  8: ['RGBA16F', 'RGBA16UI', 'RGBA16I', 'RG32F', 'RG32UI', 'RG32I', 'DEPTH32F_STENCIL8'],
  6: ['RGB16F', 'RGB16UI', 'RGB16I'],
  4: [
    'RGBA8',
    'RGBA8UI',
    'RGBA8I',
    'RGBA8_SNORM',
    'SRGB8_ALPHA8',
    'R32F',
    'R32UI',
    'R32I',
    'RG16F',
    'RG16UI',
    'RG16I',
    'RGB10_A2',
    'RGB10_A2UI',
    'R11F_G11F_B10F',
    'RGB9_E5',
    'DEPTH_COMPONENT24',
    'DEPTH_COMPONENT32F',
    'DEPTH24_STENCIL8',
    'DEPTH_STENCIL',
    'RGBA',
  ],
  3: ['RGB8', 'RGB8UI', 'RGB8I', 'SRGB8', 'RGB'],
  2: ['R16F', 'R16UI', 'R16I', 'RG8', 'RG8UI', 'RG8I', 'RGB565', 'RGBA4', 'RGB5_A1', 'DEPTH_COMPONENT16'],
  1: ['R8', 'R8UI', 'R8I', 'R8_SNORM', 'STENCIL_INDEX8', 'ALPHA', 'LUMINANCE'],
};

let webglBytes: Map<number, number> | undefined;

/** Bytes per texel of a WebGL format, sized or not. */
export function webglTexelBytes(gl: WebGL2RenderingContext, internalFormat: number, type?: number): number {
  // An unsized format has the size of the data's type.
  if (internalFormat === gl.RGBA && type === gl.FLOAT) return 16;
  if (internalFormat === gl.RGBA && type === gl.HALF_FLOAT) return 8;
  webglBytes ??= new Map(
    Object.entries(WEBGL_FORMATS).flatMap(([bytes, names]) =>
      names.map((name): [number, number] => [gl[name] as number, Number(bytes)]),
    ),
  );
  return webglBytes.get(internalFormat) ?? 4;
}
