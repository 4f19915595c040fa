/** A text in this site's local storage; null if there is none or storage is forbidden. */
export function keptText(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    // Some windows have no storage: the page then starts as on a first visit.
    return null;
  }
}

/** Stores a text, or removes it if null. Does nothing if storage is forbidden or full. */
export function keepText(key: string, text: string | null): void {
  try {
    if (text === null) localStorage.removeItem(key);
    else localStorage.setItem(key, text);
  } catch {
    // Without the text, the next visit takes one more click.
  }
}
