import type { SplatEngine } from '@websplatter/core';
import type { Views } from './views.ts';

/** The device and its objects; replaced as a whole when the device is lost. */
export interface Session {
  readonly canvas: HTMLCanvasElement;
  readonly engine: SplatEngine;
  readonly views: Views;
}
