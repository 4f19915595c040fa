/** A bufferView of a glTF as meshopt packs it (EXT_meshopt_compression, KHR_meshopt_compression). */
export interface PackedView {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /** Number of elements. */
  readonly count: number;
  /** Unpacked bytes of an element. */
  readonly strideBytes: number;
  readonly mode: 'ATTRIBUTES' | 'TRIANGLES' | 'INDICES';
  /** What is undone after unpacking; its results have as many bytes. */
  readonly filter: 'NONE' | 'OCTAHEDRAL' | 'QUATERNION' | 'EXPONENTIAL' | 'COLOR';
}

/**
 * Unpacks a view; null for bytes that are not as meshopt packs them. Its code is fetched when a file
 * first asks for it. Workers are single scripts, which fetch none, so they ask the page.
 *
 * Rejects with CodeUnavailableError, also where a content security policy forbids WebAssembly.
 */
export type DecodeMeshopt = (view: PackedView) => Promise<Uint8Array<ArrayBuffer> | null>;
