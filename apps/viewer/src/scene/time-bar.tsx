import './time-bar.css';
import { IconButton } from '@websplatter/kit/controls';
import { useEffect } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { timeAfter } from './scene-time.ts';

/** Steps of the slider over the whole range: finer than pixels. */
const STEPS = 1000;

/** Plays, pauses and scrubs a moving scene; nothing for a scene that stands still. */
export function TimeBar({ store, viewer }: PanelProps) {
  const range = useStore(store, (state) => state.scene?.timeRange ?? null);
  const time = useStore(store, (state) => state.sceneTime ?? range?.[0] ?? 0);
  const isPlaying = useStore(store, (state) => state.isScenePlaying);
  useEffect(() => {
    if (!isPlaying || !range) return;
    let lastMs: number | null = null;
    const step = (nowMs: number) => {
      const from = store.getState().sceneTime ?? range[0];
      if (lastMs !== null) viewer.setSceneTime(timeAfter(range, from, nowMs - lastMs));
      lastMs = nowMs;
      handle = requestAnimationFrame(step);
    };
    let handle = requestAnimationFrame(step);
    return () => cancelAnimationFrame(handle);
  }, [isPlaying, range, store, viewer]);
  if (!range) return null;
  const label = isPlaying ? 'Pause the scene' : 'Play the scene';
  const digits = range[1] - range[0] > 10 ? 1 : 2;
  return (
    <div className="time-bar" data-testid="time-bar">
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
        step={(range[1] - range[0]) / STEPS}
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
    </div>
  );
}
