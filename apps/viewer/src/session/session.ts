import type { SplatEngine } from '@websplatter/core';
import type { Views } from './views.ts';

/** The device and what was made on it; replaced as a whole when the device is lost. */
export interface Session {
  readonly canvas: HTMLCanvasElement;
  readonly engine: SplatEngine;
  readonly views: Views;
}
