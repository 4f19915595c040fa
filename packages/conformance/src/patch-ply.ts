import { encodePly, type SplatSet } from '@websplatter/core';

/** A value to write over one that `encodePly` wrote. */
export interface PlyPatch {
  readonly row: number;
  /** Name of the property in the header, e.g. `f_dc_0`. */
  readonly property: string;
  readonly value: number;
}

const END_OF_HEADER = 'end_header\n';

/** Encodes `set` as a PLY file and replaces single values, also by values that no set may hold. */
export function patchedPly(set: SplatSet, patches: readonly PlyPatch[]): Uint8Array<ArrayBuffer> {
  const bytes = encodePly(set);
  const view = new DataView(bytes.buffer);
  const { bodyByte, strideBytes, properties } = layoutOf(bytes);
  for (const { row, property, value } of patches) {
    const place = properties.get(property);
    if (!place || !(row < set.count)) throw new RangeError(`The file has no ${property} in row ${row}.`);
    const byte = bodyByte + row * strideBytes + place.offsetBytes;
    if (place.type === 'double') view.setFloat64(byte, value, true);
    else view.setFloat32(byte, value, true);
  }
  return bytes;
}

interface PlyLayout {
  readonly bodyByte: number;
  readonly strideBytes: number;
  readonly properties: ReadonlyMap<string, { readonly type: string; readonly offsetBytes: number }>;
}

/** Finds the values in a file made by `encodePly`, whose properties are all float or double. */
function layoutOf(bytes: Uint8Array): PlyLayout {
  const text = new TextDecoder('latin1').decode(bytes.subarray(0, 8192));
  const bodyByte = text.indexOf(END_OF_HEADER) + END_OF_HEADER.length;
  const properties = new Map<string, { type: string; offsetBytes: number }>();
  let strideBytes = 0;
  for (const [, type, name] of text.slice(0, bodyByte).matchAll(/^property (\S+) (\S+)$/gm)) {
    properties.set(name, { type, offsetBytes: strideBytes });
    strideBytes += type === 'double' ? 8 : 4;
  }
  return { bodyByte, strideBytes, properties };
}
