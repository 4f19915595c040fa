import { type FittingOptions, GpuLimitError } from '../data/errors.ts';
import { Chunk } from '../data/layout/structs.ts';
import { chunkCountOf } from '../data/packing/chunks.ts';
import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import { entryCountOf, isPalette } from '../data/packing/harmonics.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import { type CloudPrecision, ownShPrecision, type ShPrecision } from '../data/packing/precision.ts';
import { packPalette, repackHarmonics, truncateHarmonics } from '../data/packing/repack-harmonics.ts';
import { shPlaneBytes } from '../data/packing/sh-plane-bytes.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { probeMemory } from '../gpu/probe-memory.ts';

/** Settings of a loaded cloud that decide its bytes per splat. */
export interface FitSettings extends CloudPrecision {
  /** Highest degree of harmonics that is stored. */
  readonly shDegree: ShDegree;
}

/** Coarser settings that a load used because the GPU lacked memory for the wanted ones. */
export interface CloudFit {
  readonly wanted: FitSettings;
  readonly taken: FitSettings;
  /** Bytes that the wanted settings need. */
  readonly wantedBytes: number;
  /** Bytes that the taken settings need. */
  readonly takenBytes: number;
  /** An explanation for people, one sentence. */
  readonly why: string;
}

/** `exact`: a load that does not fit fails. `auto`: it takes the finest settings that fit. */
export type FitMode = 'exact' | 'auto';

interface Fitting {
  readonly memory: GpuMemory;
  /** Name of the cloud, for messages. */
  readonly name: string;
  /** Peak bytes of a load with these settings. */
  readonly bytesOf: (settings: FitSettings) => number;
  /** A failure that device limits already predict. Default: memory is probed. */
  readonly failure?: GpuLimitError;
  /** Aborts the search. */
  readonly signal: AbortSignal;
  /** Whether the geometry must keep its precision. Default: false. */
  readonly isGeometryFixed?: boolean;
}

/** Bytes of the planes and chunks of a cloud. @param paletteEntries see `shPlaneBytes`. */
export function cloudBytes(
  count: number,
  { geometryPrecision, shPrecision, shDegree }: FitSettings,
  paletteEntries?: number,
): number {
  const shBytes = shPlaneBytes(count, shDegree, shPrecision, paletteEntries);
  return 4 * GEOMETRY_WORDS[geometryPrecision] * count + shBytes + Chunk.bytes * chunkCountOf(count);
}

const COARSER_SH: Readonly<Record<ShPrecision, readonly ShPrecision[]>> = {
  f32: ['f16', 'u8'],
  f16: ['u8'],
  u8: [],
  palette: [],
};

/**
 * Settings coarser than `wanted`, the finest first: the least change of colours first, fewer bands
 * of harmonics last.
 *
 * @param isGeometryFixed whether all of them keep the precision of the geometry.
 */
export function coarserSettings(
  { geometryPrecision, shPrecision, shDegree }: FitSettings,
  isGeometryFixed = false,
): FitSettings[] {
  const coarser: FitSettings[] = [];
  const sh = shDegree > 0 ? COARSER_SH[shPrecision] : [];
  for (const each of sh) coarser.push({ geometryPrecision, shPrecision: each, shDegree });
  const coarsest = sh.at(-1) ?? shPrecision;
  const coarsestGeometry = isGeometryFixed ? geometryPrecision : 'packed';
  if (geometryPrecision !== coarsestGeometry)
    coarser.push({ geometryPrecision: coarsestGeometry, shPrecision: coarsest, shDegree });
  for (let degree = shDegree - 1; degree >= 0; degree--)
    coarser.push({
      geometryPrecision: coarsestGeometry,
      shPrecision: coarsest,
      shDegree: degree as ShDegree,
    });
  return coarser;
}

/**
 * Compares the needs of a load with the memory budget and, by a probe, with the GPU's memory.
 *
 * @returns null if `wanted` fits.
 * @throws GpuLimitError if it does not fit and `mode` is `exact`, or if no settings fit; the error
 *   names the settings that would fit. The signal's reason.
 */
export async function fitSettings(
  { memory, name, bytesOf, failure, signal, isGeometryFixed }: Fitting,
  wanted: FitSettings,
  mode: FitMode,
): Promise<CloudFit | null> {
  const hasRoomFor = async (settings: FitSettings) => {
    const hasRoom = await probeMemory(memory, bytesOf(settings));
    signal.throwIfAborted();
    return hasRoom;
  };
  const wantedBytes = bytesOf(wanted);
  if (!failure && (await hasRoomFor(wanted))) return null;
  const taken = await firstOf(coarserSettings(wanted, isGeometryFixed), hasRoomFor);
  const { heldBytes, availableBytes } = memory;
  const needs = `${name} needs ${wantedBytes} bytes of the GPU's memory with ${describe(wanted)}; ${heldBytes} are held, and there is no room for as many more`;
  if (taken && mode === 'auto') {
    const takenBytes = bytesOf(taken);
    const why = `${needs}: it has ${describe(taken)} instead, ${takenBytes} bytes.`;
    return { wanted, taken, wantedBytes, takenBytes, why };
  }
  const limit = wantedBytes > availableBytes ? 'memoryBudgetBytes' : 'memory';
  const advice = taken
    ? `With ${describe(taken)} it would fit: load it with fit: 'auto'.`
    : 'No coarser settings would fit either: load fewer splats.';
  const room = limit === 'memory' ? 0 : Math.max(0, availableBytes);
  const details = { heldBytes, fitting: taken && fittingOptions(wanted, taken), cause: failure };
  throw new GpuLimitError(limit, wantedBytes, room, `${needs}. ${advice}`, details);
}

function fittingOptions(
  wanted: FitSettings,
  { geometryPrecision, shPrecision, shDegree }: FitSettings,
): FittingOptions {
  const precision = { geometryPrecision, shPrecision };
  // No load option takes a degree; `auto` lowers it.
  return shDegree < wanted.shDegree ? { precision, fit: 'auto' } : { precision };
}

/**
 * Repacks a cloud that exceeds memory with coarser harmonics, on the CPU. Its geometry stays as
 * packed.
 *
 * @throws GpuLimitError if `mode` is `exact`, or if no settings fit; the error names the settings
 *   that would fit. The signal's reason.
 */
export async function fitPacked(
  packed: PackedCloud,
  fitting: Pick<Fitting, 'memory' | 'name' | 'failure' | 'signal'>,
  mode: FitMode,
): Promise<{ readonly packed: PackedCloud; readonly fit: CloudFit }> {
  const { count, geometry, harmonics } = packed;
  const wanted = {
    geometryPrecision: geometry.precision,
    shPrecision: harmonics.precision,
    shDegree: harmonics.degree,
  };
  const entries = isPalette(harmonics) ? entryCountOf(harmonics) : undefined;
  const bytesOf = (settings: FitSettings) => cloudBytes(count, settings, entries);
  // `fitSettings` returns null only without a failure.
  const fit = (await fitSettings({ ...fitting, bytesOf, isGeometryFixed: true }, wanted, mode))!;
  const { shDegree, shPrecision } = fit.taken;
  const fitted = isPalette(harmonics)
    ? packPalette(harmonics, shDegree)
    : repackHarmonics(truncateHarmonics(harmonics, count, shDegree), count, ownShPrecision(shPrecision));
  return { packed: { ...packed, harmonics: fitted }, fit };
}

async function firstOf<Candidate>(
  candidates: readonly Candidate[],
  isGood: (candidate: Candidate) => Promise<boolean>,
): Promise<Candidate | null> {
  for (const candidate of candidates) if (await isGood(candidate)) return candidate;
  return null;
}

function describe({ geometryPrecision, shPrecision, shDegree }: FitSettings): string {
  return `${geometryPrecision} geometry and ${shPrecision} harmonics of degree ${shDegree}`;
}
