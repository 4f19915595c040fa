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
