const KEY = 'websplatter opened file';

/**
 * Notes that a file was opened in this tab, whatever address it shows. It is no state of the
 * history's entry: Chromium 156 loses that in one of fifty reloads on a busy machine.
 */
export function noteOpenedFile(): void {
  try {
    sessionStorage.setItem(KEY, '');
  } catch {
    // Where nothing may be stored, no file is kept to be offered either.
  }
}

/** Whether a file was opened here before the page was reloaded, or left and come back to. */
export function hasOpenedFile(): boolean {
  const [load] = performance.getEntriesByType('navigation') as PerformanceNavigationTiming[];
  try {
    // A link or a person has asked for this address since.
    if (load?.type === 'navigate') sessionStorage.removeItem(KEY);
    return sessionStorage.getItem(KEY) !== null;
  } catch {
    return false;
  }
}
