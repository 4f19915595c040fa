// `npm run test:mutations -- [COUNT] [SEED]`: breaks COUNT places of core (default 200), one at a time, in a
// copy of the commit. Lists those that no test of `npm test` notices. For each place, the tests that import the
// module through the fewest others run first, and all at the end. This takes hours, and goes on where it was
// stopped: results are lines of a file in `.out`, which is named by the commit, COUNT and SEED.
import { spawnSync } from 'node:child_process';
import { appendFileSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import fc from 'fast-check';
import { ensureChromium, ensureInstalled, repositoryRoot } from '../setup.mjs';
import { mutantsOf } from './mutants.mjs';
import { importersOf, nearestTests } from './nearest-tests.mjs';

const [count = 200, seed = 1] = process.argv.slice(2).map(Number);
const out = join(repositoryRoot, '.out');
const copy = join(out, 'mutation-copy');
/** Most time for the tests of one mutant, ms: one that never ends is noticed, too. */
const LIMIT_MS = 20 * 60_000;

/** Modules of core that users run, and its shaders. */
const MODULE =
  /^(?:packages\/core\/src\/(?!testing\/).*(?<!\.test|\.d|-fixture)\.ts|(?:packages\/core|shaders)\/.*\.wgsl)$/;
/** Modules, shaders and tests through which a test may reach a module of core. */
const SOURCE = /^(?:packages|apps|shaders)\/.*\.(?:tsx?|wgsl)$/;
/** Nearest tests that run together, before the next. A fault is mostly noticed by the first. */
const NEAREST = [8, 40];
/** Projects of `npm test`. */
const TIER = ['--project', '!full:*'];

function git(...args) {
  const { status, stdout, stderr } = spawnSync('git', args, { cwd: repositoryRoot, encoding: 'utf8' });
  if (status !== 0) throw new Error(stderr);
  return stdout.trim();
}

/** Texts of the copy's files whose path matches, by path. */
function textsOf(pattern) {
  const paths = git('ls-files')
    .split('\n')
    .filter((path) => pattern.test(path));
  return new Map(paths.map((path) => [path, readFileSync(join(copy, path), 'utf8')]));
}

/** The places to break: any place of any module is as likely as any other. */
function chosenMutants() {
  const all = [...textsOf(MODULE)].flatMap(([path, text]) =>
    mutantsOf(path, text).map((mutant) => ({
      path,
      line: text.slice(0, mutant.start).split('\n').length,
      mutant,
    })),
  );
  const some = fc.shuffledSubarray(all, { minLength: count, maxLength: count });
  return fc.sample(some, { seed, numRuns: 1 })[0];
}

function run(...tests) {
  const env = {
    ...process.env,
    CI: 'true',
    NO_COLOR: '1',
    CHROMIUM_PATH: ensureChromium(),
    WEBSPLATTER_REQUIRE_GPU: '1',
  };
  const vitest = join(copy, 'node_modules/vitest/vitest.mjs');
  const options = {
    cwd: copy,
    env,
    encoding: 'utf8',
    timeout: LIMIT_MS,
    killSignal: 'SIGKILL',
    maxBuffer: 2 ** 28,
  };
  const { status, stdout } = spawnSync(
    process.execPath,
    [vitest, 'run', ...tests, ...TIER, '--bail', '1', '--passWithNoTests'],
    options,
  );
  return { isNoticed: status !== 0, firstFailure: /FAIL\s+(.*)/.exec(stdout ?? '')?.[1] ?? null };
}

/** Runs tests of the copy until one fails; returns which did. */
function noticedBy(path) {
  const tests = nearestTests(path, importers);
  for (const size of NEAREST) {
    const next = tests.splice(0, size);
    if (next.length === 0) break;
    const { isNoticed, firstFailure } = run(...next);
    if (isNoticed) return { by: `the ${size} nearest tests`, firstFailure };
  }
  const { isNoticed, firstFailure } = run();
  return { by: isNoticed ? 'all tests' : null, firstFailure };
}

ensureInstalled();
mkdirSync(out, { recursive: true });
// Another commit, or another number of places, has other places.
const outPath = join(out, `mutations-${git('rev-parse', '--short', 'HEAD')}-${count}-${seed}.jsonl`);
rmSync(copy, { recursive: true, force: true });
git('worktree', 'prune');
git('worktree', 'add', '--detach', '--force', copy, 'HEAD');
// Links of packages to each other lead to the copy; files are not copied.
spawnSync('cp', ['-al', join(repositoryRoot, 'node_modules'), join(copy, 'node_modules')]);
const done = existsSync(outPath)
  ? readFileSync(outPath, 'utf8')
      .trim()
      .split('\n')
      .filter(Boolean)
      .map((line) => JSON.parse(line))
  : [];
const importers = importersOf(textsOf(SOURCE));
const chosen = chosenMutants();
for (const { path, line, mutant } of chosen.slice(done.length)) {
  const file = join(copy, path);
  const text = readFileSync(file, 'utf8');
  const from = text.slice(mutant.start, mutant.end);
  writeFileSync(file, text.slice(0, mutant.start) + mutant.text + text.slice(mutant.end));
  const startMs = Date.now();
  const { by, firstFailure } = noticedBy(path);
  writeFileSync(file, text);
  const result = { path, line, from, to: mutant.text, by, firstFailure, elapsedMs: Date.now() - startMs };
  done.push(result);
  appendFileSync(outPath, `${JSON.stringify(result)}\n`);
  console.log(`${done.length}/${count} ${by ?? 'NOT NOTICED'}: ${path}:${line}: ${from} → ${mutant.text}`);
}
git('worktree', 'remove', '--force', copy);
const missed = done.filter(({ by }) => by === null);
console.log(`${done.length - missed.length} of ${done.length} places were noticed by a test.`);
for (const { path, line, from, to } of missed) console.log(`${path}:${line}: ${from} → ${to}`);
