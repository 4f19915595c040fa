// Counts files, small files, lines, the viewer's folders, and comments with pronouns instead of
// nouns: measures of how easily a newcomer finds the way. Prints a line per package and the sums.
//
// node packages/tools/count-house.mjs
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { repositoryRoot } from './setup.mjs';

const SOURCE = /\.(?:tsx?|m?js|css|wgsl)$/;
const TEST = /\.test\.(?:tsx?|mjs)$|^e2e\/|^packages\/core\/src\/testing\//;
/** Packages that users install, the shaders, and the viewer. */
const PRODUCT = /^(?:shaders|apps\/viewer|packages\/(?:core|three|react|cli|node|scenes|charts))\//;
const SMALL_LINES = 40;
/** Words in place of a noun that the comment does not contain. */
const RIDDLE = /\b(?:those|whoever|whatever|whichever)\b|\bwhat (?!if\b)\w+|\bthat of\b|\bnone that\b/i;

const listed = execFileSync('git', ['ls-files', '-z'], { cwd: repositoryRoot, encoding: 'utf8' }).split('\0');
const sources = listed
  .filter((path) => SOURCE.test(path) && !/\.d\.m?ts$|generated/.test(path))
  .map((path) => ({
    path,
    lines: readFileSync(join(repositoryRoot, path), 'utf8').split('\n').slice(0, -1),
  }));
const shipped = sources.filter(({ path }) => !TEST.test(path));

/** Counts comment lines, and comment lines that match `RIDDLE`. */
function countComments(lines) {
  let isInside = false;
  let comments = 0;
  let riddles = 0;
  for (const line of lines) {
    const text = line.trim();
    const isComment = isInside || /^\/[/*]/.test(text);
    if (text.startsWith('/*')) isInside = true;
    if (text.includes('*/')) isInside = false;
    if (!isComment) continue;
    comments++;
    if (RIDDLE.test(text)) riddles++;
  }
  return { comments, riddles };
}

function countsOf(files) {
  const small = files.filter(({ lines }) => lines.length < SMALL_LINES).length;
  const sum = files.reduce((total, { lines }) => total + lines.length, 0);
  const { comments, riddles } = countComments(files.flatMap(({ lines }) => lines));
  return { files: files.length, small, lines: sum, comments, riddles };
}

const rooms = groupBy(shipped, roomOf);
const rows = [...rooms].map(([name, files]) => ({ name, ...countsOf(files) }));
const viewerFolders = new Set(
  shipped.flatMap(({ path }) => /^apps\/viewer\/src\/([^/]+)\//.exec(path)?.[1] ?? []),
);
console.table([
  ...rows.sort((a, b) => b.lines - a.lines),
  { name: 'product', ...countsOf(shipped.filter(({ path }) => PRODUCT.test(path))) },
  { name: 'all but tests', ...countsOf(shipped) },
  { name: 'tests', ...countsOf(sources.filter(({ path }) => TEST.test(path))) },
]);
console.log(`The viewer has ${viewerFolders.size} folders.`);

function roomOf({ path }) {
  return /^(?:apps|packages)\/[^/]+|^[^/]+/.exec(path)[0];
}

/** `Map.groupBy`, which Node 20 lacks. */
function groupBy(values, keyOf) {
  const groups = new Map();
  for (const value of values) groups.set(keyOf(value), [...(groups.get(keyOf(value)) ?? []), value]);
  return groups;
}
