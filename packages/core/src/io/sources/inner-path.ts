/** Far above the limit of any file system, and short enough for a message. */
const MOST_PATH = 1024;

/**
 * Whether a path from a folder stays in it, whoever follows it: addresses and some systems take
 * reversed slashes, addresses take encoded dots, too, and leave out tabs and line breaks.
 */
export function isInnerPath(path: string): boolean {
  if (path.length > MOST_PATH || /^[a-z]:|\p{Cc}/iu.test(path)) return false;
  return !path.split(/[/\\]/).some((part) => /^(?:\.|%2e){0,2}$/i.test(part));
}

/**
 * The folder of a path, with its slash; none is empty. Found from the end: a pattern for what is
 * behind the last slash looks for the end from each character, and archives have paths of 65,535.
 */
export function folderOf(path: string): string {
  return path.slice(0, path.lastIndexOf('/') + 1);
}
