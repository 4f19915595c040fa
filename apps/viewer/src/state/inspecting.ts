import type { SplatSet } from '@websplatter/core';
import type { TracedSplat } from '@websplatter/core/reference';
import { NOTHING_SELECTED, type Selecting } from './selecting.ts';
import type { Vec3 } from './vec3.ts';

/** Tabs of the panel; each has its own meaning of a click in the image. */
export type InspectTab = 'splat' | 'distance' | 'histogram' | 'select' | 'crop';

/** Reading the scene's files again, whose values the GPU has no more. */
export type Reading =
  | { readonly kind: 'none' }
  /** `part`: 0…1; undefined if it is not known. */
  | { readonly kind: 'running'; readonly part: number | undefined }
  | { readonly kind: 'done' }
  | { readonly kind: 'failed'; readonly message: string };

/** A splat's share of the pixel that was clicked. */
export interface PixelShare {
  /** Opacity of the splat at the pixel. */
  readonly alpha: number;
  /** `alpha` times the transmittance of the splats in front. */
  readonly weight: number;
  /** Opacity of all splats together. */
  readonly totalOpacity: number;
  /** Place in the order of drawing, 0 for the nearest. */
  readonly rank: number;
  /** Splats that were drawn; null if that is not known. */
  readonly visible: number | null;
}

/** The splat that is inspected. */
export interface InspectedSplat {
  readonly cloudIndex: number;
  /** Row in the file. */
  readonly row: number;
  /** Null if the splat was asked for by its row. */
  readonly share: PixelShare | null;
  /** A set of this splat alone, as the file has it; null until it has been read. */
  readonly set: SplatSet | null;
  /** How the image at rest shows it; null if it does not, or before the image is at rest. */
  readonly seen: TracedSplat | null;
}

/** A distance that was measured between two points of the scene's own space. */
export interface Ruler {
  readonly id: number;
  readonly ends: readonly [Vec3, Vec3];
}

/** How long a unit of the scene is. */
export interface LengthScale {
  /** In `unit`, above 0. */
  readonly perSceneUnit: number;
  /** One of `LENGTH_UNITS`. */
  readonly unit: LengthUnit;
}

export const LENGTH_UNITS = ['mm', 'cm', 'm', 'km', 'in', 'ft'] as const;
export type LengthUnit = (typeof LENGTH_UNITS)[number];

/** Quantities by which splats are counted. */
export const QUANTITIES = ['longest', 'shortest', 'opacity'] as const;
export type Quantity = (typeof QUANTITIES)[number];

/** How many splats have a value in each bin. */
export interface Histogram {
  /** One more than there are bins, ascending. */
  readonly edges: readonly number[];
  readonly counts: readonly number[];
  /** Whether the edges are equally far apart by ratio. */
  readonly isByRatio: boolean;
}

export type Histograms = Readonly<Record<Quantity, Histogram>>;

export interface MarkedBin {
  readonly quantity: Quantity;
  readonly bin: number;
}

/** The box that splats are cropped to, in the scene's own space. */
export interface Crop {
  readonly min: Vec3;
  readonly max: Vec3;
  /** Which splats stay. */
  readonly keep: 'inside' | 'outside';
}

/** Whether a splat with this centre, in the scene's own space, stays. */
export function isKept({ min, max, keep }: Crop, [x, y, z]: Vec3): boolean {
  const isInside = x >= min[0] && x <= max[0] && y >= min[1] && y <= max[1] && z >= min[2] && z <= max[2];
  return isInside === (keep === 'inside');
}

export interface Inspecting {
  readonly tab: InspectTab;
  readonly reading: Reading;
  readonly splat: InspectedSplat | null;
  /** Why the last click or row came to nothing. */
  readonly problem: string | null;
  readonly rulers: readonly Ruler[];
  /** The first end of the next ruler. */
  readonly rulerStart: Vec3 | null;
  /** Null until a known length has been set. */
  readonly scale: LengthScale | null;
  readonly histograms: Histograms | null;
  /** The bin whose splats are marked in the image. */
  readonly marked: MarkedBin | null;
  readonly crop: Crop | null;
  /** Splats that the crop keeps and that are not removed; null until they have been counted. */
  readonly cropCount: number | null;
  readonly selecting: Selecting;
}

/** State that every scene begins with. */
export const NOTHING_INSPECTED: Inspecting = {
  tab: 'splat',
  reading: { kind: 'none' },
  splat: null,
  problem: null,
  rulers: [],
  rulerStart: null,
  scale: null,
  histograms: null,
  marked: null,
  crop: null,
  cropCount: null,
  selecting: NOTHING_SELECTED,
};

/**
 * After files have joined the scene, left it or moved: facts about its splats no longer hold;
 * distances, crop and selection stay.
 */
export function withoutSplats(inspecting: Inspecting): Inspecting {
  const { splat, problem, histograms, marked, cropCount } = NOTHING_INSPECTED;
  const hasNone = inspecting.splat === splat && inspecting.histograms === histograms;
  if (hasNone && inspecting.cropCount === cropCount) return inspecting;
  return { ...inspecting, splat, problem, histograms, marked, cropCount };
}

export interface InspectingState {
  /** Inspection, distances and crop of this scene; another scene begins without any. */
  readonly inspecting: Inspecting;
}

export const FIRST_INSPECTING: InspectingState = { inspecting: NOTHING_INSPECTED };
