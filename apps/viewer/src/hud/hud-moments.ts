import type { EngineMemory, FrameStatistics, SplatEngine } from '@websplatter/core';
import { flushSync } from 'react-dom';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { FrameRecorder, Side } from './frame-recorder.ts';

/** Figures that change faster cannot be read. */
export const FIGURES_INTERVAL_MS = 250;
/** Memory changes seldom, and listing it takes longer than all other figures. */
const MEMORY_INTERVAL_MS = 1000;

/** The values that all figures show until the next moment. */
export interface HudMoment {
  readonly state: ViewerState;
  /** Null but for the largest size. */
  readonly large: LargeMoment | null;
}

/** The values that only the largest size shows. */
export interface LargeMoment {
  /** The last frames, oldest first; the same lists as before unless there are new frames. */
  readonly frames: Readonly<Record<Side, readonly FrameStatistics[]>>;
  readonly renderMs: readonly number[];
  readonly ownMs: readonly number[];
  /** Null without a GPU. */
  readonly memory: { readonly held: EngineMemory; readonly maxBufferBytes: number } | null;
}

/** State that figures show. Other state changes more often, such as a dragged camera. */
const SHOWN: readonly (keyof ViewerState)[] = [
  'statistics',
  'rasterizer',
  'rightStatistics',
  'rightRasterizer',
  'frameRate',
  'isIdle',
  'scene',
  'inspecting',
  'load',
  'status',
  'widthPx',
  'heightPx',
  'adapterLabel',
  'accuracy',
  'comparison',
  'drawnDetail',
  'movingScale',
  'streaming',
];

export interface HudSources {
  readonly store: ViewerStore;
  readonly recorder: FrameRecorder;
  /** The engine whose memory is shown; null while there is no GPU. */
  readonly engine: () => SplatEngine | null;
}

/**
 * An external store for React of values that were taken at one moment: at most once in
 * `FIGURES_INTERVAL_MS`, and at once when a person freezes the figures or lets them go on.
 */
export function hudMoments({ store, recorder, engine }: HudSources, isLarge: boolean) {
  let frames: LargeMoment['frames'] = { left: [], right: [] };
  let framesRevision = Number.NaN;
  let memory: LargeMoment['memory'] = null;
  let memoryMs = Number.NEGATIVE_INFINITY;
  const readLarge = (nowMs: number): LargeMoment => {
    if (framesRevision !== recorder.revision) {
      framesRevision = recorder.revision;
      frames = { left: recorder.frames('left'), right: recorder.frames('right') };
    }
    if (!recorder.shown.isHudFrozen && nowMs - memoryMs >= MEMORY_INTERVAL_MS) {
      const current = engine();
      memoryMs = nowMs;
      memory = current && {
        held: current.memory(),
        maxBufferBytes: current.device.limits.maxBufferSize,
      };
    }
    return { frames, renderMs: recorder.renderMs, ownMs: recorder.ownMs, memory };
  };
  let momentMs = performance.now();
  const read = (): HudMoment => ({ state: recorder.shown, large: isLarge ? readLarge(momentMs) : null });
  let moment = read();
  return {
    getSnapshot: () => moment,
    subscribe: (onChange: () => void) => {
      let timer: ReturnType<typeof setTimeout> | undefined;
      let memoryTimer: ReturnType<typeof setTimeout> | undefined;
      const take = () => {
        clearTimeout(timer);
        clearTimeout(memoryTimer);
        timer = undefined;
        momentMs = performance.now();
        moment = read();
        // The panel's own time includes that of React and of its charts.
        flushSync(onChange);
        recorder.spend(performance.now() - momentMs);
        // The memory shown was read earlier, perhaps of another scene. It is read again after MEMORY_INTERVAL_MS.
        if (isLarge && !recorder.shown.isHudFrozen && memoryMs < momentMs)
          memoryTimer = setTimeout(take, memoryMs + MEMORY_INTERVAL_MS - momentMs);
      };
      const takeSoon = () => {
        timer ??= setTimeout(take, Math.max(0, momentMs + FIGURES_INTERVAL_MS - performance.now()));
      };
      // Frames may have been drawn since the first moment.
      if (recorder.shown !== moment.state) takeSoon();
      const unsubscribe = store.subscribe((state, before) => {
        if (state.isHudFrozen !== before.isHudFrozen) take();
        else if (!state.isHudFrozen && SHOWN.some((name) => state[name] !== before[name])) takeSoon();
      });
      return () => {
        unsubscribe();
        clearTimeout(timer);
        clearTimeout(memoryTimer);
      };
    },
  };
}
