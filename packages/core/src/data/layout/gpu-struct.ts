/** Size and alignment in bytes, and 32-bit components. */
interface TypeLayout {
  readonly bytes: number;
  readonly alignment: number;
  readonly components: number;
  readonly scalar: 'f32' | 'u32';
}

/** WGSL types of the fields of GPU structs, in addition to arrays of vec4f and vec4u. */
const TYPES = {
  f32: { bytes: 4, alignment: 4, components: 1, scalar: 'f32' },
  u32: { bytes: 4, alignment: 4, components: 1, scalar: 'u32' },
  vec2f: { bytes: 8, alignment: 8, components: 2, scalar: 'f32' },
  vec2u: { bytes: 8, alignment: 8, components: 2, scalar: 'u32' },
  vec3f: { bytes: 12, alignment: 16, components: 3, scalar: 'f32' },
  vec4f: { bytes: 16, alignment: 16, components: 4, scalar: 'f32' },
  vec4u: { bytes: 16, alignment: 16, components: 4, scalar: 'u32' },
  /** Columns are padded to 16 bytes. */
  mat3x3f: { bytes: 48, alignment: 16, components: 9, scalar: 'f32' },
  mat4x4f: { bytes: 64, alignment: 16, components: 16, scalar: 'f32' },
} as const satisfies Record<string, TypeLayout>;

type SimpleType = keyof typeof TYPES;
/** Arrays of other elements would be padded in uniform buffers. */
export type GpuType = SimpleType | `array<${'vec4f' | 'vec4u'}, ${number}>`;

type ScalarType = { [T in SimpleType]: (typeof TYPES)[T]['components'] extends 1 ? T : never }[SimpleType];
type FieldValue<T extends GpuType> = T extends ScalarType ? number : ArrayLike<number>;

export type GpuFields = Readonly<Record<string, GpuType>>;
export type GpuValues<Fields extends GpuFields> = {
  readonly [Name in keyof Fields]: FieldValue<Fields[Name]>;
};

/** A struct that the GPU and the CPU share: defined once, with its WGSL text generated from it. */
export interface GpuStruct<Fields extends GpuFields> {
  readonly name: string;
  readonly fields: Fields;
  /** Offset of each field, in bytes. */
  readonly offsets: { readonly [Name in keyof Fields]: number };
  /** Size and array stride, in bytes. */
  readonly bytes: number;
  readonly wgsl: string;
  /** A buffer with one struct that holds `values`. */
  pack(values: GpuValues<Fields>): ArrayBuffer;
  /** Writes `values` at `byteOffset`, a multiple of 4, into a buffer of whole words. */
  write(target: ArrayBuffer, values: GpuValues<Fields>, byteOffset?: number): void;
}

/**
 * Lays out a struct by WGSL's rules, which for these types are the same for uniform and storage
 * buffers.
 *
 * @throws RangeError for an unknown type, such as an array whose length is not a whole number of 1
 *   or more.
 *
 * @__NO_SIDE_EFFECTS__
 */
export function gpuStruct<const Fields extends GpuFields>(name: string, fields: Fields): GpuStruct<Fields> {
  const offsets: Record<string, number> = {};
  const layouts = Object.entries(fields).map(([field, type]) => [field, layoutOf(type)] as const);
  let end = 0;
  let alignment = 4;
  for (const [field, layout] of layouts) {
    offsets[field] = roundUp(end, layout.alignment);
    end = offsets[field] + layout.bytes;
    alignment = Math.max(alignment, layout.alignment);
  }
  const lines = Object.entries(fields).map(([field, type]) => `  ${field}: ${type},`);
  // One array instead of lookups by name: frames write a struct per page.
  const places = layouts.map(([field, layout]) => ({
    field,
    type: fields[field],
    word: offsets[field] / 4,
    layout,
  }));
  return {
    name,
    fields,
    offsets: offsets as { [Name in keyof Fields]: number },
    bytes: roundUp(end, alignment),
    wgsl: `struct ${name} {\n${lines.join('\n')}\n}`,
    pack(values) {
      const packed = new ArrayBuffer(this.bytes);
      this.write(packed, values);
      return packed;
    },
    write(target, values, byteOffset = 0) {
      const floats = new Float32Array(target, byteOffset);
      const words = new Uint32Array(target, byteOffset);
      for (const place of places) {
        writeField(place.layout.scalar === 'f32' ? floats : words, place, values[place.field]);
      }
    },
  };
}

export function roundUp(value: number, multiple: number): number {
  return Math.ceil(value / multiple) * multiple;
}

/** Returns the number of 32-bit components that a field takes. @throws RangeError for an unknown type. */
export function componentsOf(type: GpuType): number {
  return layoutOf(type).components;
}

function layoutOf(type: GpuType): TypeLayout {
  if (Object.hasOwn(TYPES, type)) return TYPES[type as SimpleType];
  const [, element, count] = /^array<(vec4[fu]), ([1-9]\d*)>$/.exec(type) ?? [];
  if (!count) throw new RangeError(`${type} is not a type of struct fields.`);
  const { bytes, alignment, components, scalar } = TYPES[element as 'vec4f' | 'vec4u'];
  return { bytes: bytes * Number(count), alignment, components: components * Number(count), scalar };
}

/** Place of a field in its struct. */
interface FieldPlace {
  readonly type: GpuType;
  /** Offset in 32-bit words. */
  readonly word: number;
  readonly layout: TypeLayout;
}

function writeField(
  view: Float32Array | Uint32Array,
  { type, word, layout }: FieldPlace,
  value: number | ArrayLike<number>,
): void {
  const { components, bytes } = layout;
  if (word + bytes / 4 > view.length) throw new RangeError(`There is no room for a ${type} at word ${word}.`);
  if (typeof value === 'number') {
    view[word] = value;
    return;
  }
  if (value.length !== components)
    throw new RangeError(`${type} takes ${components} values, not ${value.length}.`);
  if (type === 'mat3x3f') {
    // Columns are padded to four words.
    for (let i = 0; i < 9; i++) view[word + i + Math.floor(i / 3)] = value[i];
  } else {
    view.set(value, word);
  }
}
