import type { SplatEngine } from '@websplatter/core';

/** Is told when a device is lost. */
export interface LossListener {
  readonly onLost: (info: GPUDeviceLostInfo) => void;
}

/**
 * Tells `listener` when the engine's device is lost, if it is still in memory then. A device may live
 * longer than engines, renderers and splats, so that its loss must keep none of them.
 */
export function tellOfLoss(engine: SplatEngine, listener: LossListener): void {
  const held = new WeakRef(listener);
  void engine.lost.then((info) => held.deref()?.onLost(info));
}
