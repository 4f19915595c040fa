import { useSyncExternalStore } from 'react';
import { NO_DEVICE, type SplatDevice, splatDevice, watchSplatDevice } from './splat-device.ts';

/**
 * Returns how the page's `<SplatCanvas>` is doing for a GPU: also outside of it, where it can say so
 * while nothing is drawn. Renders again when that changes, and each second while it waits. Of
 * several, it is the one that fares worst. `none` on a server.
 */
export function useSplatDevice(): SplatDevice {
  return useSyncExternalStore(watchSplatDevice, splatDevice, () => NO_DEVICE);
}
