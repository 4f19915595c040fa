import { MeshoptEncoder } from 'meshoptimizer/encoder';
import type { AnyJson, GltfFixture } from './gltf-fixture.ts';

/** How bufferViews are packed. */
export interface MeshoptOptions {
  readonly extension?: 'EXT_meshopt_compression' | 'KHR_meshopt_compression';
  /** Of the codec; KHR has 1. */
  readonly version?: 0 | 1;
  /** Filter of each bufferView; default none. */
  readonly filterOf?: (view: number) => 'NONE' | 'EXPONENTIAL' | 'QUATERNION';
  /** Whether buffers of unpacked bytes are declared, as gltfpack does, without an address. */
  readonly hasFallback?: boolean;
}

/**
 * Packs all bufferViews of a file by npm's encoder. Views that have a filter hold float32: those of
 * QUATERNION become normalised int16.
 */
export async function meshoptPacked(
  { json, binary }: GltfFixture,
  { extension = 'EXT_meshopt_compression', version = 0, filterOf, hasFallback = true }: MeshoptOptions = {},
): Promise<GltfFixture> {
  await MeshoptEncoder.ready;
  const packed: AnyJson = structuredClone(json);
  const parts: Uint8Array[] = [];
  let byteOffset = 0;
  for (const [i, view] of (packed.bufferViews as AnyJson[]).entries()) {
    const accessors = (packed.accessors as AnyJson[]).filter(({ bufferView }) => bufferView === i);
    const [{ count, type }] = accessors;
    const size = type === 'SCALAR' ? 1 : Number(type.slice(3));
    const start = view.byteOffset ?? 0;
    const bytes = binary.slice(start, start + view.byteLength);
    const filter = filterOf?.(i) ?? 'NONE';
    let byteStride = view.byteStride ?? 4 * size;
    let source = bytes;
    if (filter !== 'NONE') {
      const floats = new Float32Array(bytes.buffer);
      if (filter === 'QUATERNION') {
        byteStride = 8;
        for (const accessor of accessors) Object.assign(accessor, { componentType: 5122, normalized: true });
        source = Uint8Array.from(MeshoptEncoder.encodeFilterQuat(floats, count, byteStride, 16));
      } else source = Uint8Array.from(MeshoptEncoder.encodeFilterExp(floats, count, byteStride, 24));
    }
    const encoded = MeshoptEncoder.encodeGltfBuffer(source, count, byteStride, 'ATTRIBUTES', version);
    parts.push(encoded);
    packed.bufferViews[i] = {
      buffer: hasFallback ? 1 : 0,
      byteLength: count * byteStride,
      ...(view.byteStride && { byteStride }),
      extensions: {
        [extension]: {
          ...{ buffer: 0, byteOffset, byteLength: encoded.length, byteStride, count, mode: 'ATTRIBUTES' },
          ...(filter !== 'NONE' && { filter }),
        },
      },
    };
    byteOffset += encoded.length;
  }
  const bytes = new Uint8Array(byteOffset);
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  packed.buffers = [{ byteLength: byteOffset }];
  if (hasFallback)
    packed.buffers.push({ byteLength: binary.length, extensions: { [extension]: { fallback: true } } });
  packed.extensionsUsed.push(extension);
  packed.extensionsRequired = [extension];
  return { json: packed, binary: bytes };
}
