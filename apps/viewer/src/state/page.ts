/** Panels beside the image; one at a time. */
export type DockName = 'open' | 'view' | 'clouds' | 'inspect' | 'accuracy' | 'effects' | 'save';

/** Tabs of the panel that saves, by purpose. */
export type SaveTab = 'share' | 'picture' | 'file';

/** Extent of the frames' figures: their pace, also their stages, or all that is known. */
export const HUD_SIZES = ['small', 'medium', 'large'] as const;
export type HudSize = (typeof HUD_SIZES)[number];

/** Everything on the page besides the picture. */
export interface PageState {
  /** Whether there are a toolbar, panels and their keys; `?noui` has none. */
  readonly hasInterface: boolean;
  /** The panel that is shown beside the image. */
  readonly dock: DockName | null;
  /** The tab of the panel that saves, also while that is closed. */
  readonly saveTab: SaveTab;
  /** Height of a panel that is a sheet, as on phones, as a part of the window's: of `SHEET_PARTS`. */
  readonly sheetPart: number;
  readonly isHelpVisible: boolean;
  readonly isHudVisible: boolean;
  /** Null: as the window has room. */
  readonly hudSize: HudSize | null;
  /** Whether the figures stay as they are, to be read and copied. */
  readonly isHudFrozen: boolean;
  /** Whether the list of reasons for which splats were left out is open. */
  readonly isDroppedVisible: boolean;
}

export const FIRST_PAGE: PageState = {
  hasInterface: true,
  dock: null,
  saveTab: 'share',
  sheetPart: 0.5,
  isHelpVisible: false,
  isHudVisible: true,
  hudSize: null,
  isHudFrozen: false,
  isDroppedVisible: false,
};
