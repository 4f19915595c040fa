import { noteCalls, replaceMethod } from './replace-method.ts';

/** Called around each pass and copy that anything on the page records. */
export interface PassListener {
  /** @param name what the pass is, in words. @returns the number of the pass. */
  before(encoder: GPUCommandEncoder, name: string): number;
  after(encoder: GPUCommandEncoder, pass: number): void;
}

export interface PassWatch {
  listener: PassListener | null;
}

const COPIES = [
  'copyBufferToBuffer',
  'copyBufferToTexture',
  'copyTextureToBuffer',
  'copyTextureToTexture',
] as const;

/** Wraps the recording of passes and copies. */
export function watchPasses(): PassWatch {
  const watch: PassWatch = { listener: null };
  if (!('GPU' in globalThis)) return watch;
  const textures = new WeakMap<object, GPUTexture>();
  const canvasTextures = new WeakSet<GPUTexture>();
  /** Passes that the listener heard begin. */
  const begun = new WeakMap<object, { readonly encoder: GPUCommandEncoder; readonly number: number }>();

  const textureOf = (view: object): GPUTexture | undefined =>
    view instanceof GPUTexture ? view : textures.get(view);
  const attachmentName = (
    view: object,
    load: GPULoadOp | undefined,
    store: GPUStoreOp | undefined,
    isResolved: boolean,
  ): string => {
    const texture = textureOf(view);
    if (!texture) return `${load}, ${store}`;
    const { format, width, height, sampleCount } = texture;
    const kind = canvasTextures.has(texture) ? `canvas ${format}` : format;
    const samples = sampleCount > 1 ? `, ${sampleCount} samples` : '';
    return `${load} and ${store} ${kind} ${width}×${height}${samples}${isResolved ? ', resolved' : ''}`;
  };
  const renderName = ({
    label,
    colorAttachments,
    depthStencilAttachment: depth,
  }: GPURenderPassDescriptor) => {
    const colors = [...colorAttachments].flatMap((each) =>
      each ? attachmentName(each.view, each.loadOp, each.storeOp, !!each.resolveTarget) : [],
    );
    const depths = depth ? [attachmentName(depth.view, depth.depthLoadOp, depth.depthStoreOp, false)] : [];
    return `${label || 'unnamed'}: ${[...colors, ...depths].join('; ')}`;
  };

  noteCalls(GPUTexture.prototype, 'createView', (texture, _args, view) => textures.set(view, texture));
  noteCalls(GPUCanvasContext.prototype, 'getCurrentTexture', (_context, _args, texture) =>
    canvasTextures.add(texture),
  );
  const begin = <Pass extends object>(
    encoder: GPUCommandEncoder,
    name: () => string,
    pass: () => Pass,
  ): Pass => {
    const { listener } = watch;
    if (!listener) return pass();
    const number = listener.before(encoder, name());
    const made = pass();
    begun.set(made, { encoder, number });
    return made;
  };
  replaceMethod(
    GPUCommandEncoder.prototype,
    'beginRenderPass',
    (beginPass) =>
      function (this: GPUCommandEncoder, descriptor) {
        return begin(
          this,
          () => renderName(descriptor),
          () => beginPass.call(this, descriptor),
        );
      },
  );
  replaceMethod(
    GPUCommandEncoder.prototype,
    'beginComputePass',
    (beginPass) =>
      function (this: GPUCommandEncoder, descriptor) {
        const name = () => `${descriptor?.label || 'unnamed'}: compute`;
        return begin(this, name, () => beginPass.call(this, descriptor));
      },
  );
  const ended = (pass: object) => {
    const noted = begun.get(pass);
    if (noted) watch.listener?.after(noted.encoder, noted.number);
  };
  noteCalls(GPURenderPassEncoder.prototype, 'end', ended);
  noteCalls(GPUComputePassEncoder.prototype, 'end', ended);
  for (const copy of COPIES)
    replaceMethod(
      GPUCommandEncoder.prototype as unknown as Record<string, (...args: unknown[]) => void>,
      copy,
      (record) =>
        function (this: GPUCommandEncoder, ...args: unknown[]) {
          const { listener } = watch;
          const number = listener?.before(this, copyName(copy, args));
          record.apply(this, args);
          listener?.after(this, number!);
        },
    );
  return watch;
}

/** Buffers that are copied are small, and many: they share a name. */
function copyName(name: (typeof COPIES)[number], [source, , size]: readonly unknown[]): string {
  if (name !== 'copyTextureToTexture') return name;
  const { format } = (source as GPUTexelCopyTextureInfo).texture;
  const [width, height] = Array.isArray(size) ? size : Object.values(size as object);
  return `${name}: ${format} ${width}×${height}`;
}
