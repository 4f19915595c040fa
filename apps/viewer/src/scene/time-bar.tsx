import './time-bar.css';
import { IconButton } from '@websplatter/kit/controls';
import { formatBytes, formatBytesOf } from '@websplatter/kit/format';
import { useEffect, useMemo } from 'react';
import { useStore } from 'zustand';
import { type SceneTiming, timeAfter, timingOf } from '../engine/play/scene-time.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { LoadState } from '../state/scene.ts';
import { withCode } from '../ui/lazy.tsx';

/** The times of the scene on the screen, the same object while they stay the same; null if it stands still. */
export function useSceneTiming({ store, viewer }: PanelProps): SceneTiming | null {
  // Frames of a scene come with every render.
  useStore(store, (state) => state.scene);
  const timing = timingOf(viewer.scenes.drawable);
  const [first, last] = timing?.range ?? [];
  // biome-ignore lint/correctness/useExhaustiveDependencies: these are all that it holds.
  return useMemo(() => timing, [first, last, timing?.framesPerS]);
}

/** Steps of the slider over the whole range, unless frames are steps: finer than pixels. */
const STEPS = 1000;

/** Plays, pauses and scrubs a moving scene; nothing for a scene that stands still. */
export function TimeBar({ store, viewer }: PanelProps) {
  const timing = useSceneTiming({ store, viewer });
  const range = timing?.range;
  const time = useStore(store, (state) => state.sceneTime ?? range?.[0] ?? 0);
  const isPlaying = useStore(store, (state) => state.isScenePlaying);
  const isAwaited = useStore(store, (state) => state.isFrameAwaited);
  const load = useStore(store, (state) => state.frameLoad);
  const framesPerS = timing?.framesPerS ?? null;
  const hasFrames = framesPerS !== null;
  useEffect(() => {
    if (!isPlaying || !timing) return;
    let lastMs: number | null = null;
    const step = (nowMs: number) => {
      const { sceneTime, isFrameAwaited } = store.getState();
      if (lastMs !== null && !isFrameAwaited)
        viewer.setSceneTime(timeAfter(timing, sceneTime ?? timing.range[0], nowMs - lastMs));
      lastMs = nowMs;
      handle = requestAnimationFrame(step);
    };
    let handle = requestAnimationFrame(step);
    return () => cancelAnimationFrame(handle);
  }, [isPlaying, timing, store, viewer]);
  useEffect(() => {
    if (!hasFrames) return;
    let stop: (() => void) | null = null;
    let isOver = false;
    // Few scenes have frames.
    void withCode(
      store,
      () => import('../engine/play/frame-player.ts'),
      ({ playFrames }) => {
        if (!isOver) stop = playFrames({ store, viewer });
      },
    );
    return () => {
      isOver = true;
      stop?.();
    };
  }, [hasFrames, store, viewer]);
  if (!range) return null;
  const label = isPlaying ? 'Pause the scene' : 'Play the scene';
  const digits = range[1] - range[0] > 10 ? 1 : 2;
  return (
    <div className="time-bar" data-testid="time-bar" data-awaited={isAwaited || undefined}>
      <IconButton
        icon={isPlaying ? 'pause' : 'play'}
        label={label}
        title={label}
        testId="play-scene"
        onClick={() => store.setState({ isScenePlaying: !isPlaying })}
      />
      <input
        type="range"
        aria-label="Time of the scene"
        aria-valuetext={`${time.toFixed(digits)} of ${range[0]} to ${range[1]}`}
        min={range[0]}
        max={range[1]}
        step={framesPerS ? 1 / framesPerS : (range[1] - range[0]) / STEPS}
        value={time}
        data-testid="scene-time"
        onChange={({ target }) => {
          store.setState({ isScenePlaying: false });
          viewer.setSceneTime(target.valueAsNumber);
        }}
      />
      <output className="time-bar-time" data-testid="scene-time-text">
        {time.toFixed(digits)}
      </output>
      {load && (isPlaying || isAwaited) && <FrameFigures load={load} />}
    </div>
  );
}

/** Bytes of a file of frames so far, and their rate. */
function FrameFigures({ load: { loadedBytes, totalBytes = 0, bytesPerSecond } }: { load: LoadState }) {
  return (
    <span className="time-bar-load" data-testid="frame-load">
      {`${formatBytesOf(loadedBytes, totalBytes)} · ${formatBytes(bytesPerSecond)}/s`}
    </span>
  );
}
