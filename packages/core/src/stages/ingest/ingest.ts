import { INGEST_FACTS } from '../../data/layout/ingest-facts.ts';
import { PACKING_STRUCTS } from '../../data/layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import type { GeometryPrecision, RowPrecision } from '../../data/packing/precision.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import { ROW_SLOT } from '../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../data/splats/splat-set.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../family-texts.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob(
    [
      './*.wgsl',
      '../../../../../shaders/lib/{drop-reason,exact-exp,float-bits,harmonics-packing,pack-splat}.wgsl',
    ],
    { query: '?raw', import: 'default', eager: true },
  ),
  PACKING_STRUCTS,
);

export interface IngestVariant extends RowPrecision {
  /** Degree to store. */
  readonly shDegree: ShDegree;
  /** Where rows share their harmonics: see `RowPalette`. */
  readonly entryValues?: number;
  /** Whether harmonics are bytes: see `ByteValues`. Default: false. */
  readonly hasByteHarmonics?: boolean;
}

/** Parameters of ingest-rows for a piece of a file. */
export function pieceParameters({ offsets, byteHarmonics, ...layout }: RowLayout, rowCount: number) {
  const paddedOffsets = new Uint32Array(60);
  paddedOffsets.set(offsets);
  const { scale = 0, offset = 0, least = 0, most = 0 } = byteHarmonics?.values ?? {};
  const harmonicsStrideBytes = byteHarmonics?.strideBytes ?? 0;
  const strideBytes = layout.strideBytes - harmonicsStrideBytes;
  return {
    offsets: paddedOffsets,
    byteValues: Float32Array.of(scale, offset, least, most),
    strideBytes,
    isBigEndian: Number(layout.isBigEndian),
    harmonicsByte: rowCount * strideBytes,
    harmonicsStrideBytes,
  };
}

/** Packs rows of a file as they arrive, and gathers facts about them. */
export function ingestRows({
  geometryPrecision,
  shPrecision,
  shDegree,
  entryValues = 0,
  hasByteHarmonics = false,
}: IngestVariant): StageDefinition {
  const hasPalette = shDegree >= 1 && entryValues > 0;
  return computeStage('ingest-rows', {
    texts,
    conditions: {
      GEOMETRY_F32: geometryPrecision === 'f32',
      SH_1: shDegree >= 1,
      ROW_PALETTE: hasPalette,
      ROW_BYTE_HARMONICS: shDegree >= 1 && hasByteHarmonics,
      SH_F32: shPrecision === 'f32',
      SH_F16: shPrecision === 'f16',
      SH_U8: shPrecision === 'u8',
    },
    constants: {
      ...INGEST_FACTS,
      GEOMETRY_WORDS: GEOMETRY_WORDS[geometryPrecision],
      SH_BANDS: shDegree,
      SH_VALUES: coefficientsPerSplat(shDegree),
      SH_WORDS: shWordsPerSplat(shDegree, shPrecision),
      ENTRY_VALUES: entryValues,
      ROW_POSITION: ROW_SLOT.position,
      ROW_LOG_SCALE: ROW_SLOT.logScale,
      ROW_ROTATION: ROW_SLOT.rotation,
      ROW_OPACITY: ROW_SLOT.opacity,
      ROW_COLOR: ROW_SLOT.colorDc,
      ROW_HARMONICS: ROW_SLOT.harmonics,
    },
  });
}

/** Makes the sort keys that put splats into storage order. */
export function ingestKeys(geometryPrecision: GeometryPrecision): StageDefinition {
  return computeStage('ingest-keys', {
    texts,
    constants: { GEOMETRY_WORDS: GEOMETRY_WORDS[geometryPrecision] },
  });
}

/** Writes one word of all splats of a page. */
export const ingestScatter: StageDefinition = /* @__PURE__ */ computeStage('ingest-scatter', {
  texts,
});

/** Takes the bounds of each chunk of a page, and settles its splats. */
export function ingestChunks(geometryPrecision: GeometryPrecision): StageDefinition {
  return computeStage('ingest-chunks', {
    texts,
    conditions: { GEOMETRY_F32: geometryPrecision === 'f32' },
    constants: { GEOMETRY_WORDS: GEOMETRY_WORDS[geometryPrecision] },
  });
}
