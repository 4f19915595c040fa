import type { ByteLedger } from './byte-ledger.ts';
import { noteCalls } from './replace-method.ts';
import { webglTexelBytes } from './texture-bytes.ts';

type Gl = WebGL2RenderingContext;

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

  // biome-ignore lint/suspicious/noExplicitAny: overloads, of which types know the last alone
  const watch = (name: keyof Gl, noted: (context: Gl, ...args: any[]) => void) =>
    noteCalls(gl as unknown as Record<string, (...args: unknown[]) => void>, name, (context, args) =>
      noted(context as unknown as Gl, ...args),
    );
  const sizeOf = (context: Gl, format: number, sizes: readonly number[], type?: number) =>
    sizes.reduce((product, size) => product * size, webglTexelBytes(context, format, type));
  watch('bufferData', (context, target, data, _usage, _offset, length) => {
    const bytes = typeof data === 'number' ? data : (data?.byteLength ?? 0);
    note(buffer(context, target), length ? length * data.BYTES_PER_ELEMENT : bytes);
  });
  watch('texImage2D', (context, target, level, format, width, height, _border, _format, type, ...pixels) => {
    // Short forms take their size from an image; splat renderers do not use them for splats.
    if (pixels.length > 0)
      note(
        texture(context, target),
        sizeOf(context, format, [width, height], type),
        `${target} level ${level}`,
      );
  });
  watch('texImage3D', (context, target, level, format, width, height, depth, _border, _format, type) => {
    const bytes = sizeOf(context, format, [width, height, depth], type);
    note(texture(context, target), bytes, `${target} level ${level}`);
  });
  watch('texStorage2D', (context, target, levels, format, width, height) =>
    note(texture(context, target), withLevels(levels) * sizeOf(context, format, [width, height])),
  );
  watch('texStorage3D', (context, target, levels, format, width, height, depth) =>
    note(texture(context, target), withLevels(levels) * sizeOf(context, format, [width, height, depth])),
  );
  watch('renderbufferStorage', (context, _target, format, width, height) =>
    note(context.getParameter(gl.RENDERBUFFER_BINDING), sizeOf(context, format, [width, height])),
  );
  watch('renderbufferStorageMultisample', (context, _target, samples, format, width, height) =>
    note(context.getParameter(gl.RENDERBUFFER_BINDING), sizeOf(context, format, [samples, width, height])),
  );
  for (const name of ['deleteBuffer', 'deleteTexture', 'deleteRenderbuffer'] as const)
    watch(name, (_context, object) => object && ledger.delete(object));
}

/** A full chain of levels adds a third. */
function withLevels(levels: number): number {
  return levels > 1 ? 4 / 3 : 1;
}
