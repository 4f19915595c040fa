import type { ByteLedger } from './byte-ledger.ts';
import { replaceMethod } from './replace-method.ts';
import { webglTexelBytes } from './texture-bytes.ts';

type Gl = WebGL2RenderingContext;
type BufferDataArguments = [
  target: number,
  data: number | AllowSharedBufferSource | null,
  usage: number,
  offset?: number,
  length?: number,
];

/** Wraps WebGL 2: counts the bytes of buffers, textures and renderbuffers. */
export function watchWebGl(ledger: ByteLedger): void {
  const gl = WebGL2RenderingContext.prototype;
  const bufferBindings = new Map<number, number>([
    [gl.ARRAY_BUFFER, gl.ARRAY_BUFFER_BINDING],
    [gl.ELEMENT_ARRAY_BUFFER, gl.ELEMENT_ARRAY_BUFFER_BINDING],
    [gl.PIXEL_PACK_BUFFER, gl.PIXEL_PACK_BUFFER_BINDING],
    [gl.PIXEL_UNPACK_BUFFER, gl.PIXEL_UNPACK_BUFFER_BINDING],
    [gl.UNIFORM_BUFFER, gl.UNIFORM_BUFFER_BINDING],
    [gl.TRANSFORM_FEEDBACK_BUFFER, gl.TRANSFORM_FEEDBACK_BUFFER_BINDING],
    [gl.COPY_READ_BUFFER, gl.COPY_READ_BUFFER_BINDING],
    [gl.COPY_WRITE_BUFFER, gl.COPY_WRITE_BUFFER_BINDING],
  ]);
  const textureBindings = new Map<number, number>([
    [gl.TEXTURE_2D, gl.TEXTURE_BINDING_2D],
    [gl.TEXTURE_2D_ARRAY, gl.TEXTURE_BINDING_2D_ARRAY],
    [gl.TEXTURE_3D, gl.TEXTURE_BINDING_3D],
  ]);
  const note = (object: object | null, bytes: number, part?: string) => {
    if (object) ledger.set(object, bytes, part);
  };
  const buffer = (context: Gl, target: number) =>
    context.getParameter(bufferBindings.get(target) ?? gl.ARRAY_BUFFER_BINDING);
  // All other targets are the cube map and its faces.
  const texture = (context: Gl, target: number) =>
    context.getParameter(textureBindings.get(target) ?? gl.TEXTURE_BINDING_CUBE_MAP);

  replaceMethod(
    gl,
    'bufferData',
    (bufferData) =>
      function (this: Gl, ...args: BufferDataArguments) {
        const [target, data, , , length] = args;
        const bytes = typeof data === 'number' ? data : (data?.byteLength ?? 0);
        note(buffer(this, target), length ? length * (data as Uint8Array).BYTES_PER_ELEMENT : bytes);
        return bufferData.apply(this, args as never);
      } as Gl['bufferData'],
  );
  const sizeOf = (context: Gl, format: number, sizes: readonly number[], type?: number) =>
    sizes.reduce((product, size) => product * size, webglTexelBytes(context, format, type));
  replaceMethod(
    gl,
    'texImage2D',
    (texImage2D) =>
      function (this: Gl, ...args: number[]) {
        const [target, level, format, width, height, , , type] = args;
        // Short forms take their size from an image; splat renderers do not use them for splats.
        if (args.length >= 9)
          note(
            texture(this, target),
            sizeOf(this, format, [width, height], type),
            `${target} level ${level}`,
          );
        return texImage2D.apply(this, args as never);
      } as Gl['texImage2D'],
  );
  replaceMethod(
    gl,
    'texImage3D',
    (texImage3D) =>
      function (this: Gl, ...args: number[]) {
        const [target, level, format, width, height, depth, , , type] = args;
        note(
          texture(this, target),
          sizeOf(this, format, [width, height, depth], type),
          `${target} level ${level}`,
        );
        return texImage3D.apply(this, args as never);
      } as Gl['texImage3D'],
  );
  replaceMethod(
    gl,
    'texStorage2D',
    (texStorage2D) =>
      function (this: Gl, target, levels, format, width, height) {
        note(texture(this, target), withLevels(levels) * sizeOf(this, format, [width, height]));
        return texStorage2D.call(this, target, levels, format, width, height);
      },
  );
  replaceMethod(
    gl,
    'texStorage3D',
    (texStorage3D) =>
      function (this: Gl, target, levels, format, width, height, depth) {
        note(texture(this, target), withLevels(levels) * sizeOf(this, format, [width, height, depth]));
        return texStorage3D.call(this, target, levels, format, width, height, depth);
      },
  );
  replaceMethod(
    gl,
    'renderbufferStorage',
    (renderbufferStorage) =>
      function (this: Gl, target, format, width, height) {
        note(this.getParameter(gl.RENDERBUFFER_BINDING), sizeOf(this, format, [width, height]));
        return renderbufferStorage.call(this, target, format, width, height);
      },
  );
  replaceMethod(
    gl,
    'renderbufferStorageMultisample',
    (renderbufferStorage) =>
      function (this: Gl, target, samples, format, width, height) {
        note(this.getParameter(gl.RENDERBUFFER_BINDING), sizeOf(this, format, [samples, width, height]));
        return renderbufferStorage.call(this, target, samples, format, width, height);
      },
  );
  for (const name of ['deleteBuffer', 'deleteTexture', 'deleteRenderbuffer'] as const)
    replaceMethod(
      gl as Record<typeof name, (object: object | null) => void>,
      name,
      (destroy) =>
        function (this: Gl, object: object | null) {
          if (object) ledger.delete(object);
          destroy.call(this, object);
        },
    );
}

/** A full chain of levels adds a third. */
function withLevels(levels: number): number {
  return levels > 1 ? 4 / 3 : 1;
}
