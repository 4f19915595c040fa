import { SplatFileError } from '../../../data/errors.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import { latin1 } from '../first-bytes.ts';
import { FILTER_PROPERTY } from './fuse-filter.ts';
import { rowBytes } from './ply-binary.ts';
import { readPlyHeader, shPropertiesOf, TYPE_BYTES } from './ply-header.ts';

/** A run of consecutive rows: index of the first, and number of rows. */
export type RowRun = readonly [first: number, count: number];

/** The splats of a binary PLY, with random access to rows. */
export interface PlyRows {
  readonly count: number;
  readonly strideBytes: number;
  readonly isLittleEndian: boolean;
  /** Byte offsets in a row of its float32 log scales. */
  readonly scaleOffsets: readonly number[];
  /** Byte offset in a row of filter_3D; undefined unless it is float32. */
  readonly filterOffset: number | undefined;
  readonly shDegree: ShDegree;
  /** Makes a PLY of these rows, by references to the file instead of copies. */
  readonly fileOf: (runs: readonly RowRun[]) => File;
}

/**
 * Opens a PLY for random access to its rows. Only the header is read.
 *
 * Rejects with SplatFileError: 'bad-header', 'bad-property', 'truncated'; 'unknown-format' if the
 * rows do not have one length. Rejects with SplatSourceError, and with the signal's reason.
 */
export async function openPlyRows(file: Blob, name: string, signal?: AbortSignal): Promise<PlyRows> {
  const reader = new ByteReader({ name, stream: file.stream() }, signal);
  try {
    const { elements, format } = await readPlyHeader(reader, name);
    const text = latin1(new Uint8Array(await file.slice(0, reader.byteOffset).arrayBuffer()));
    const index = elements.findIndex((element) => element.name === 'vertex');
    const vertex = elements[index];
    const widths = elements.slice(0, index + 1).map(rowBytes);
    const isSplats = ['f_dc_0', 'rot_0'].every((each) => vertex?.properties.some((own) => own.name === each));
    if (!isSplats || format === 'ascii' || widths.includes(undefined)) {
      const message =
        'only a binary PLY of splats as trained, without lists, can be read in parts. Open it as a whole.';
      throw new SplatFileError('unknown-format', name, message);
    }
    const strideBytes = widths[index]!;
    const start = elements
      .slice(0, index)
      .reduce((sum, { count }, i) => sum + count * widths[i]!, reader.byteOffset);
    if (start + vertex.count * strideBytes > file.size) {
      const needed = start + vertex.count * strideBytes;
      const message = `its ${vertex.count} splats end at byte ${needed}, the file at ${file.size}. Download or export it again.`;
      throw new SplatFileError('truncated', name, message, { element: 'vertex', byte: file.size });
    }
    const fileOf = (runs: readonly RowRun[]) => {
      const total = runs.reduce((sum, [, count]) => sum + count, 0);
      const slices = runs.map(([first, count]) =>
        file.slice(start + first * strideBytes, start + (first + count) * strideBytes),
      );
      return new File([latin1Bytes(withCounts(text, total)), ...slices], name);
    };
    const scaleOffsets: number[] = [];
    let filterOffset: number | undefined;
    let offset = 0;
    for (const property of vertex.properties) {
      if (property.type === 'float32') {
        if (/^scale_\d$/.test(property.name)) scaleOffsets.push(offset);
        if (property.name === FILTER_PROPERTY) filterOffset = offset;
      }
      offset += TYPE_BYTES[property.type];
    }
    const isLittleEndian = format === 'binary_little_endian';
    const { count } = vertex;
    const { degree: shDegree } = shPropertiesOf(vertex, name);
    return { count, strideBytes, isLittleEndian, scaleOffsets, filterOffset, shDegree, fileOf };
  } finally {
    reader.close();
  }
}

/** The header with other vertex counts, and without other elements. */
function withCounts(header: string, vertices: number): string {
  return header.replace(
    /((?:^|[\r\n])[ \t]*element[ \t]+(\S+)[ \t]+)\d+/g,
    (_, before, name) => `${before}${name === 'vertex' ? vertices : 0}`,
  );
}

function latin1Bytes(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(text, (character) => character.charCodeAt(0));
}
