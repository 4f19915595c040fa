/** Far above the limit of any file system, and short enough for a message. */
const MOST_PATH = 1024;

/**
 * Whether a relative path stays within its folder in every interpretation. URLs and some systems
 * accept backslashes; URLs also accept encoded dots, and ignore tabs and line breaks.
 */
export function isInnerPath(path: string): boolean {
  if (path.length > MOST_PATH || /^[a-z]:|\p{Cc}/iu.test(path)) return false;
  return !path.split(/[/\\]/).some((part) => /^(?:\.|%2e){0,2}$/i.test(part));
}

/**
 * The folder of a path, with its trailing slash; empty if there is none. Searched from the end: a
 * regular expression would take quadratic time, and archives have paths of up to 65,535 characters.
 */
export function folderOf(path: string): string {
  return path.slice(0, path.lastIndexOf('/') + 1);
}
