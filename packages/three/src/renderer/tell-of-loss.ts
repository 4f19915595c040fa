import type { SplatEngine } from '@websplatter/core';

/** Object with a callback for the loss of a device. */
export interface LossListener {
  readonly onLost: (info: GPUDeviceLostInfo) => void;
}

/**
 * Calls `listener.onLost` when the engine's device is lost. Holds the listener weakly: a device may
 * outlive engines, renderers and splats, and must not keep them in memory.
 */
export function tellOfLoss(engine: SplatEngine, listener: LossListener): void {
  const held = new WeakRef(listener);
  void engine.lost.then((info) => held.deref()?.onLost(info));
}
