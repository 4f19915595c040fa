import { useSyncExternalStore } from 'react';
import { NO_DEVICE, type SplatDevice, splatDevice, watchSplatDevice } from './splat-device.ts';

/**
 * Returns the state of the GPU device of the page's `<SplatCanvas>`; the worst state if there are
 * several. Works also outside of the Canvas, to show a message while nothing is drawn. Renders again
 * when the state changes, and each second of a wait. `none` on a server.
 */
export function useSplatDevice(): SplatDevice {
  return useSyncExternalStore(watchSplatDevice, splatDevice, () => NO_DEVICE);
}
