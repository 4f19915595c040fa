import { resolveAccuracy } from '@websplatter/core';
import { createStore, type StoreApi } from 'zustand/vanilla';
import { NOTHING_INSPECTED } from './inspecting.ts';
import { FIRST_LOOK } from './look.ts';
import { NO_EFFECTS } from './requested-effects.ts';
import { FIRST_SHEET_PART } from './sheet.ts';
import type { ViewerState } from './viewer-state.ts';

export type ViewerStore = StoreApi<ViewerState>;

export function createViewerStore(): ViewerStore {
  const defaultAccuracy = resolveAccuracy();
  return createStore<ViewerState>(() => ({
    status: 'starting',
    statusReason: '',
    isCodeMissing: false,
    retryWaitMs: null,
    scene: null,
    load: null,
    waiting: [],
    selectedPart: null,
    preparing: null,
    saving: null,
    picturing: null,
    failure: null,
    warning: null,
    lastFile: null,
    notice: null,
    cameraIndex: 0,
    isOwnCamera: false,
    isFlipped: false,
    hasInterface: true,
    isZUp: false,
    look: FIRST_LOOK,
    viewMode: 'colours',
    savedViews: [],
    isPathPlaying: false,
    flightSpeed: null,
    isHudVisible: true,
    hudSize: 'medium',
    isHudFrozen: false,
    isHelpVisible: false,
    dock: null,
    sheetPart: FIRST_SHEET_PART,
    accuracyTab: 'measure',
    accuracy: defaultAccuracy,
    defaultAccuracy,
    target: null,
    choice: null,
    accuracyNotices: [],
    detail: 'full',
    comparison: null,
    measuring: null,
    failedMeasurement: null,
    measured: null,
    effects: [],
    effectCosts: null,
    requested: NO_EFFECTS,
    isRevealPlaying: false,
    inspecting: NOTHING_INSPECTED,
    errorFigures: null,
    mapFigures: null,
    splitPart: 0.5,
    isDroppedVisible: false,
    adapterLabel: '',
    widthPx: 0,
    heightPx: 0,
    imageId: 0,
    restedFrames: 0,
    statistics: null,
    rasterizer: null,
    drawnDetail: 'full',
    rightStatistics: null,
    rightRasterizer: null,
    lastRender: null,
    frameRate: null,
    isIdle: true,
  }));
}
