/** Longest time that a page may still be fetching the file it saves, ms. */
const DOWNLOAD_MS = 60_000;

/** Hands a file to the browser, which saves it under `fileName`. */
export function download(file: Blob, fileName: string): void {
  const href = URL.createObjectURL(file);
  Object.assign(document.createElement('a'), { href, download: fileName }).click();
  setTimeout(() => URL.revokeObjectURL(href), DOWNLOAD_MS);
}
