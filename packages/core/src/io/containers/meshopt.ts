/** A bufferView of a glTF as meshopt packs it (EXT_meshopt_compression, KHR_meshopt_compression). */
export interface PackedView {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /** Number of elements. */
  readonly count: number;
  /** Unpacked bytes of an element. */
  readonly strideBytes: number;
  readonly mode: 'ATTRIBUTES' | 'TRIANGLES' | 'INDICES';
  /** Filter that is reversed after unpacking; it does not change the number of bytes. */
  readonly filter: 'NONE' | 'OCTAHEDRAL' | 'QUATERNION' | 'EXPONENTIAL' | 'COLOR';
}

/**
 * Unpacks a view; null for malformed bytes. The decoder is fetched when a file first needs it.
 * Workers are single scripts that cannot fetch code, so they ask the page.
 *
 * Rejects with CodeUnavailableError, also if a content security policy forbids WebAssembly.
 */
export type DecodeMeshopt = (view: PackedView) => Promise<Uint8Array<ArrayBuffer> | null>;
