// `npm run smear [COMMIT]`: counts, per feature, the files outside of its own folders that name it: what somebody
// must know of to change it. Tests and prose do not count.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { repositoryRoot } from './setup.mjs';

const SOURCE = /^(?:shaders|packages\/core\/src)\/.*\.(?:ts|wgsl)$/;
const TEST = /\.(?:test|bench)\.ts$|^packages\/core\/src\/testing\//;

/** Words of each feature, and the folders and files that are its own. */
const FEATURES = [
  ['motion', /motion/i, /\/features\/motion\/|motion-properties/],
  ['morph', /morph/i, /\/morph\//],
  ['skin', /\bskin|skin(?:ned|s)?\b|Skin/, /\/skin\/|bind-skeleton/],
  ['edits', /\bedit(?:s|or|ed|ing)?\b|Edit(?:s|or|ing)/, /\/editing\/|\/edits\//],
  ['GPU splats', /gpu-?splats/i, /gpu-splats/],
  ['levels', /levels?\b|Levels?\b|LEVELS/, /\/(?:levels|cut|merge)\/|cloud-levels|level-/],
  ['streams', /\bstream(?:s|ed|ing)?\b|Stream/, /\/(?:stream|bricks|leaves)\//],
  ['instances', /\binstances\b|Instances\b|INSTANCES/, /cloud-instances|lib\/instances|\/instances\//],
  ['palettes', /palettes?/i, /palette/],
  ['volumes', /volumes?\b|Volumes?\b/, /\/volumes\//],
  ['shadows', /shadows?\b|Shadows?\b/, /\/shadows\//],
  ['software', /\bNARROW\b|isNarrow|software/i, /\/narrow\//],
];

const [commit] = process.argv.slice(2);
const git = (...args) =>
  execFileSync('git', args, { cwd: repositoryRoot, encoding: 'utf8', maxBuffer: 2 ** 28 });
const paths = (commit ? git('ls-tree', '-r', '--name-only', commit) : git('ls-files'))
  .split('\n')
  .filter((path) => SOURCE.test(path) && !TEST.test(path));
const files = paths.map((path) => ({
  path,
  // Comments and texts name features, too, but nobody must change code there.
  code: (commit
    ? git('show', `${commit}:${path}`)
    : readFileSync(join(repositoryRoot, path), 'utf8')
  ).replace(/\/\*[\s\S]*?\*\/|\/\/.*/g, ''),
}));
console.table(
  FEATURES.map(([feature, words, own]) => {
    const named = files.filter(({ path, code }) => own.test(path) || words.test(code));
    const outside = named.filter(({ path }) => !own.test(path));
    const rooms = new Set(outside.map(({ path }) => path.split('/').slice(0, 4).join('/')));
    return {
      feature,
      'files of its own': named.length - outside.length,
      outside: outside.length,
      rooms: rooms.size,
    };
  }),
);
