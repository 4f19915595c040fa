import { Listeners } from '@websplatter/core';
import { useSyncExternalStore } from 'react';

/** State of a `<SplatCanvas>`'s GPU device. */
export interface SplatDevice {
  /**
   * `none`: there is no `<SplatCanvas>`; `pending`: it requests its first device; `ready`: it draws;
   * `lost`: its device was lost, and it requests another; `retrying`: it waits before the request;
   * `gone`: it has given up, and an error boundary has received its error.
   */
  readonly status: 'none' | 'pending' | 'ready' | 'lost' | 'retrying' | 'gone';
  /** Seconds left to wait, a whole number; null unless `retrying`. */
  readonly retryInSeconds: number | null;
}

/** From best to worst. */
const RANKS: readonly SplatDevice['status'][] = ['none', 'ready', 'pending', 'lost', 'retrying', 'gone'];

export const NO_DEVICE: SplatDevice = { status: 'none', retryInSeconds: null };

/** The newest state of each owner of a device: a `<SplatCanvas>`. */
const states = new WeakMap<object, SplatDevice>();
/** Mounted owners, and owners with status `gone` until another owner is mounted. */
const owners = new Set<object>();
const listeners = new Listeners();
let worst = NO_DEVICE;

/** Returns the state of the page's owner; the worst state if there are several owners. */
export function splatDevice(): SplatDevice {
  return worst;
}

/** Calls `listener` when the state changes, until the returned function is called. */
export function watchSplatDevice(listener: () => void): () => void {
  return listeners.add(listener);
}

/** Sets the state of an owner, and calls listeners if the page's state changes. */
export function setSplatDevice(
  owner: object,
  status: SplatDevice['status'],
  retryInSeconds: number | null = null,
): void {
  states.set(owner, { status, retryInSeconds });
  update();
}

/** Adds an owner; the returned function removes it. */
export function mountSplatDevice(owner: object): () => void {
  for (const other of owners) if (states.get(other)?.status === 'gone') owners.delete(other);
  owners.add(owner);
  update();
  return () => {
    // An owner that has given up is unmounted by its error boundary: keep its state.
    if (states.get(owner)?.status !== 'gone') owners.delete(owner);
    update();
  };
}

function update(): void {
  const rankOf = ({ status }: SplatDevice) => RANKS.indexOf(status);
  const before = worst;
  worst = NO_DEVICE;
  for (const owner of owners) {
    const state = states.get(owner) ?? NO_DEVICE;
    if (rankOf(state) > rankOf(worst)) worst = state;
  }
  if (worst.status === before.status && worst.retryInSeconds === before.retryInSeconds) return;
  listeners.call();
}

/**
 * Returns how the page's `<SplatCanvas>` is doing for a GPU: also outside of it, where it can say so
 * while nothing is drawn. Renders again when that changes, and each second while it waits. Of
 * several, it is the one that fares worst. `none` on a server.
 *
 * @example
 * function Device() {
 *   const { status, retryInSeconds } = useSplatDevice();
 *   return status === 'retrying' && <p>The GPU was lost. Next attempt in {retryInSeconds} s.</p>;
 * }
 */
export function useSplatDevice(): SplatDevice {
  return useSyncExternalStore(watchSplatDevice, splatDevice, () => NO_DEVICE);
}
