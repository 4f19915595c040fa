import { addressedScene } from './addressed-scene.ts';

const KEY = 'websplatter opened file';

/**
 * Notes that a file was opened in this tab, in place of the scene that the page's address asks for.
 * It is no state of the history's entry: Chromium 156 loses that where the address changes while
 * the page is reloaded, and then reloads the address from before.
 */
export function noteOpenedFile(): void {
  try {
    sessionStorage.setItem(KEY, askedScene());
  } catch {
    // Where nothing may be stored, no file is kept to be offered either.
  }
}

/** Whether a file was opened in this tab in place of the scene that the page's address asks for. */
export function hasOpenedFile(): boolean {
  try {
    return sessionStorage.getItem(KEY) === askedScene();
  } catch {
    return false;
  }
}

function askedScene(): string {
  return JSON.stringify(addressedScene(new URLSearchParams(location.search)));
}
