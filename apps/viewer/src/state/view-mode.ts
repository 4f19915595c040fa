import type { FrameRasterizer } from '@websplatter/core';
import type { EffectsState } from './effects.ts';

/** Content of the picture; the first is the picture as the scene was trained. */
export const VIEW_MODE_NAMES = [
  'colours',
  'ellipsoids',
  'centres',
  'depth',
  'opacity',
  'harmonics',
  'overdraw',
  'detail',
  'tile-cost',
  'pixel-cost',
  'contribution',
] as const;

export type ViewModeName = (typeof VIEW_MODE_NAMES)[number];

/** Modes that lay a map over the picture once it is at rest, and draw no effects. */
export type MapModeName = Extract<ViewModeName, 'tile-cost' | 'pixel-cost' | 'contribution'>;

export function isMapMode(name: ViewModeName): name is MapModeName {
  return VIEW_MODE_NAMES.indexOf(name) >= VIEW_MODE_NAMES.indexOf('tile-cost');
}

/** The mode `steps` further in the list, which begins again behind its end. */
export function viewModeAfter(name: ViewModeName, steps: number): ViewModeName {
  const count = VIEW_MODE_NAMES.length;
  return VIEW_MODE_NAMES[(VIEW_MODE_NAMES.indexOf(name) + steps + count) % count];
}

/** Figures of a view mode's map. */
export type MapFigures = {
  readonly mode: MapModeName;
  /** `restedFrames` of the picture that was counted. */
  readonly restedFrames: number;
} & (
  | {
      readonly kind: 'cost';
      /** The rasteriser of the picture: tiles go through lists, quads blend everything. */
      readonly rasterizer: FrameRasterizer;
      readonly max: number;
      readonly mean: number;
      /** End of the colour scale; 1 % of tiles or pixels may have more. */
      readonly end: number;
      /** Part of the steps that blend a splat, 0…1. */
      readonly blendedPart: number;
    }
  | {
      readonly kind: 'contribution';
      /** Splats that culling kept. */
      readonly splats: number;
      /** Kept splats that contribute too little to be seen. */
      readonly unseen: number;
    }
  /** Why there is no map. */
  | { readonly kind: 'failure'; readonly message: string }
);

export interface ViewModeState {
  readonly viewMode: ViewModeName;
  /** Figures of the view mode's map; while the picture moves, the figures of its last rest. */
  readonly mapFigures: MapFigures | null;
}

export const FIRST_VIEW_MODE: ViewModeState = { viewMode: 'colours', mapFigures: null };

/** Whether the code of the view mode is being fetched: until it is there, there is no picture. */
export function awaitsViewMode({
  viewMode,
  requested,
}: Pick<ViewModeState & EffectsState, 'viewMode' | 'requested'>): boolean {
  return viewMode !== 'colours' && !isMapMode(viewMode) && requested['view-mode'].length === 0;
}
