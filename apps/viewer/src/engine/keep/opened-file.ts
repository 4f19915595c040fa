import { addressedScene } from '../link/addressed-scene.ts';

const KEY = 'websplatter opened file';

/**
 * Records that a file was opened in this tab instead of the scene of the page's URL. The history
 * entry's state cannot hold this: Chromium 156 loses it if the URL changes during a reload. The
 * reload then uses the old URL.
 */
export function noteOpenedFile(): void {
  try {
    sessionStorage.setItem(KEY, askedScene());
  } catch {
    // Without storage, no file is remembered, so none is offered either.
  }
}

/** Whether a file was opened in this tab instead of the scene of the page's URL. */
export function hasOpenedFile(): boolean {
  try {
    return sessionStorage.getItem(KEY) === askedScene();
  } catch {
    // Without storage, no file was remembered.
    return false;
  }
}

function askedScene(): string {
  return JSON.stringify(addressedScene(new URLSearchParams(location.search)));
}
