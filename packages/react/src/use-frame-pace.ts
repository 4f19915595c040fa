import { addAfterEffect, addEffect, context, type RootStore } from '@react-three/fiber';
import type { SplatEngine } from '@websplatter/core';
import { LoopPace } from '@websplatter/three';
import { useContext, useEffect } from 'react';

interface PacedCanvas {
  readonly stop: () => void;
  /** Mounted components that need the pace. */
  users: number;
}

const pacedCanvases = new Map<RootStore, PacedCanvas>();

/**
 * Makes the surrounding Canvas skip frames while the GPU of `engine` is behind, once for all
 * components that call this. A Canvas out of sight would otherwise submit far ahead of a slow GPU.
 */
export function useFramePace(engine: SplatEngine | null): void {
  const store = useContext(context);
  useEffect(() => {
    if (!engine || !store) return;
    const canvas = canvasOf(store);
    const paced = pacedCanvases.get(canvas) ?? { stop: paceFrames(canvas, engine), users: 0 };
    pacedCanvases.set(canvas, paced);
    paced.users++;
    return () => {
      if (--paced.users > 0) return;
      pacedCanvases.delete(canvas);
      paced.stop();
    };
  }, [store, engine]);
}

/** Returns the store of the Canvas around any portals. */
function canvasOf(store: RootStore): RootStore {
  const { previousRoot } = store.getState();
  return previousRoot ? canvasOf(previousRoot) : store;
}

/**
 * Skips whole frames, `useFrame` included, as a slower display would. Only the loop of
 * react-three-fiber is paced: `advance()` and XR draw at once. The last requested frame is drawn when
 * the GPU has caught up.
 *
 * @returns a function that ends this.
 */
function paceFrames(canvas: RootStore, { device }: SplatEngine): () => void {
  const pace = new LoopPace();
  let hasFrame = false;
  let hasLeftOut = false;
  /** Set to inactive between both effects of a skipped frame, so that the loop skips it. */
  let held: { active: boolean } | null = null;

  const release = () => {
    if (held) held.active = true;
    held = null;
  };
  const drawLeftOut = () => {
    if (!hasLeftOut || pace.isBehind) return;
    hasLeftOut = false;
    // Restarts the loop too: it ends when no Canvas has drawn.
    canvas.getState().invalidate();
  };
  const stopBefore = addEffect(() => {
    // The `useFrame` of another Canvas may have thrown, which ends an iteration of the loop.
    release();
    const { frameloop, gl, internal } = canvas.getState();
    hasFrame = internal.active && (frameloop === 'always' || internal.frames > 0) && !gl.xr?.isPresenting;
    if (!hasFrame || !pace.isBehind) return;
    held = internal;
    held.active = false;
  });
  const stopAfter = addAfterEffect(() => {
    if (held) hasLeftOut = true;
    else if (hasFrame) void pace.submitted(device.queue).then(drawLeftOut);
    release();
  });
  return () => {
    release();
    stopBefore();
    stopAfter();
  };
}
