// `npm run check:packages`: packs the published packages and checks the tarballs.
//
// - publint, attw and `npm publish --dry-run` report nothing, not even suggestions.
// - README, LICENSE, changelog and complete manifests are included; no link of a packed page is dead.
// - No script, including the viewer's, evaluates code from text.
// - Sizes stay within .size-limit.json, and the viewer's scripts within VIEWER_LIMITS; none imports itself.
import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join, posix, relative } from 'node:path';
import { publint } from 'publint';
import { formatMessage } from 'publint/utils';
import { build } from 'vite';
import { importPackedDocs, PUBLISHED, pack } from '../pack.mjs';
import { fail, PROJECTS, repositoryRoot } from '../setup.mjs';
import { codeFromText } from './code-from-text.mjs';
import { manifestProblems, missingExports } from './manifests.mjs';
import { scriptCircles, scriptSizes } from './script-sizes.mjs';

/**
 * Most gzip bytes of the viewer's scripts: before requesting a GPU, for the first picture, and all.
 * The hashes in file names alone change `all` by up to about 150 bytes from commit to commit.
 */
const VIEWER_LIMITS = { start: 118_300, initial: 199_700, all: 520_600 };

/**
 * Modules that do not count towards `all`. The viewer loads the hard cases only to show one of them.
 * Readers and framing on the main thread only replace workers that cannot start. Pages, projects,
 * videos, files of frames and of camera paths, walks and the meshopt decoder are fetched on demand, and
 * few visits need them. The viewer makes no splats in buffers.
 */
const VIEWER_APART = [
  'apps/viewer/src/engine/open/all-cases.ts',
  'apps/viewer/src/engine/play/frame-player.ts',
  'apps/viewer/src/engine/play/open-frame-file.ts',
  'apps/viewer/src/share/pages.ts',
  'apps/viewer/src/share/projects.ts',
  'apps/viewer/src/project/open-project.ts',
  'apps/viewer/src/path/path-files.ts',
  'apps/viewer/src/share/video-writer.ts',
  'apps/viewer/src/navigate/walks.ts',
  'packages/core/src/io/formats/thread-readers.ts',
  'packages/core/src/io/containers/decode-meshopt.ts',
  'packages/core/src/framing/framing-builder.ts',
  'packages/core/src/features/gpu-splats/gpu-splats.clouds.ts',
  'packages/core/src/io/loading/serve-load.ts',
].map((path) => posix.relative('apps/viewer', path));

const folder = mkdtempSync(join(tmpdir(), 'websplatter-packages-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

const packed = await pack(folder).catch((error) => fail(error.stderr || error.message));
const problems = (
  await Promise.all([
    ...PUBLISHED.map(missingFiles),
    ...PUBLISHED.map(changelogProblems),
    allManifestProblems(),
    publishProblems(),
    viewerProblems(),
    PUBLISHED.flatMap((name) => scriptProblems(join(repositoryRoot, 'packages', name, 'dist'))),
    ...packed.map(({ tarball }) => publintProblems(tarball)),
    contentProblems(packed),
    // One after the other, since each uses a whole core.
    attwProblems(packed.map(({ tarball }) => tarball)),
    sizeProblems(),
  ])
).flat();
for (const problem of problems) console.error(problem);
if (problems.length > 0) fail(`\n${problems.length} package checks failed.`);
console.log(
  `publint, attw and npm publish --dry-run report nothing for ${packed.map(({ name }) => name).join(', ')}.`,
);

function missingFiles(name) {
  const path = (file) => join(repositoryRoot, 'packages', name, file);
  const missing = [];
  if (!existsSync(path('README.md'))) missing.push(`packages/${name}: README.md is missing`);
  const license = readFileSync(join(repositoryRoot, 'LICENSE'), 'utf8');
  if (!existsSync(path('LICENSE')) || readFileSync(path('LICENSE'), 'utf8') !== license)
    missing.push(`packages/${name}: LICENSE is not a copy of the repository's`);
  return missing;
}

function allManifestProblems() {
  const root = readManifest('.');
  const folders = root.workspaces.flatMap((pattern) =>
    pattern.endsWith('/*') ? packagesIn(pattern.slice(0, -'/*'.length)) : [pattern],
  );
  folders.push(...Object.keys(PROJECTS));
  const manifests = Object.fromEntries(folders.map((path) => [path, readManifest(path)]));
  return manifestProblems(
    root,
    manifests,
    PUBLISHED.map((name) => `packages/${name}`),
  );
}

function packagesIn(path) {
  return readdirSync(join(repositoryRoot, path))
    .map((name) => `${path}/${name}`)
    .filter((each) => existsSync(join(repositoryRoot, each, 'package.json')));
}

function readManifest(path) {
  return JSON.parse(readFileSync(join(repositoryRoot, path, 'package.json'), 'utf8'));
}

function changelogProblems(name) {
  const path = `packages/${name}/CHANGELOG.md`;
  const { version } = readManifest(`packages/${name}`);
  const hasSection = readFileSync(join(repositoryRoot, path), 'utf8').includes(`\n## ${version}\n`);
  return hasSection ? [] : [`${path}: there is no section for ${version}`];
}

/** Runs `npm publish` in the packages' folders as a dry run, without a registry. */
async function publishProblems() {
  const workspaces = PUBLISHED.flatMap((name) => ['--workspace', `packages/${name}`]);
  const args = ['publish', '--dry-run', '--offline', '--ignore-scripts', '--loglevel', 'warn', ...workspaces];
  const { status, stderr } = await run('npm', args, { shell: process.platform === 'win32' });
  if (status !== 0) return [`npm publish --dry-run:\n${stderr}`];
  const warnings = stderr.match(/^npm warn publish .*$/gm) ?? [];
  return warnings.filter((line) => !line.includes('requires you to be logged in'));
}

/** Builds the viewer and checks its scripts and their sizes. */
async function viewerProblems() {
  const outDir = join(folder, 'viewer');
  const configFile = join(repositoryRoot, 'apps/viewer/vite.config.ts');
  await build({ configFile, logLevel: 'error', build: { outDir, manifest: true } });
  const { initial: start } = scriptSizes(outDir, ['viewer'], VIEWER_APART);
  const sizes = { start, ...scriptSizes(outDir, ['viewer', 'engine'], VIEWER_APART) };
  console.log(
    `The viewer's scripts: ${sizes.start} bytes before a GPU is asked for, ${sizes.initial} for the first picture, ` +
      `${sizes.all} in all, by gzip.`,
  );
  const tooLarge = Object.entries(VIEWER_LIMITS)
    .filter(([what, limit]) => sizes[what] > limit)
    .map(([what, limit]) => `viewer: its scripts (${what}) have ${sizes[what]} bytes, of at most ${limit}`);
  const circles = scriptCircles(outDir).map(
    (file) => `viewer: ${file} imports itself by way of other scripts`,
  );
  return [...tooLarge, ...circles, ...scriptProblems(outDir)];
}

/** Checks the scripts in a folder, as built. */
function scriptProblems(built) {
  return readdirSync(built, { recursive: true })
    .filter((name) => name.endsWith('.js'))
    .map((name) => join(built, name))
    .flatMap((path) => codeFromText(relative(repositoryRoot, path), readFileSync(path, 'utf8')));
}

async function publintProblems(tarball) {
  const { messages, pkg } = await publint({
    pack: { tarball: new Uint8Array(readFileSync(tarball)).buffer },
    level: 'suggestion',
    strict: true,
  });
  return messages.map((message) => `publint, ${pkg.name}: ${formatMessage(message, pkg)}`);
}

/** Unpacks the tarballs, and checks links of their pages and targets of their exports. */
async function contentProblems(packed) {
  const { deadLinks } = await importPackedDocs();
  const problems = [];
  for (const { name, tarball } of packed) {
    const unpacked = join(folder, 'unpacked', name);
    mkdirSync(unpacked, { recursive: true });
    // Every system that builds this has a tar; npm's own is no dependency.
    const { status, stderr } = await run('tar', ['-xzf', tarball, '-C', unpacked]);
    if (status !== 0) return [`${tarball}: ${stderr}`];
    const files = new Map(
      readdirSync(join(unpacked, 'package'), { recursive: true, withFileTypes: true })
        .filter((entry) => entry.isFile())
        .map((entry) => join(entry.parentPath, entry.name))
        .map((path) => [
          relative(join(unpacked, 'package'), path).replaceAll('\\', '/'),
          /\.(?:md|json)$/.test(path) ? readFileSync(path, 'utf8') : '',
        ]),
    );
    for (const file of ['README.md', 'LICENSE', 'CHANGELOG.md'])
      if (!files.has(file)) problems.push(`${name}: ${file} is not packed`);
    problems.push(...missingExports(JSON.parse(files.get('package.json')), new Set(files.keys())));
    problems.push(...deadLinks(files).map((problem) => `${name}: ${problem}`));
  }
  return problems;
}

async function attwProblems(tarballs) {
  const problems = [];
  for (const tarball of tarballs) {
    // There is one module format: CommonJS loads it by `require`, as Node supports since 20.19.
    const rules = ['--ignore-rules', 'cjs-resolves-to-esm'];
    const args = [tarball, ...rules, '--format', 'ascii', '--no-color', '--no-emoji'];
    const { status, stdout, stderr } = await runTool('@arethetypeswrong/cli/dist/index.js', args);
    if (status !== 0) problems.push(`attw, ${basename(tarball)}:\n${stdout}${stderr}`);
  }
  return problems;
}

async function sizeProblems() {
  const { status, stdout, stderr } = await runTool('size-limit/bin.js', []);
  if (status !== 0) return [`size-limit:\n${stdout}${stderr}`];
  console.log(stdout.trimEnd());
  return [];
}

/** Runs a tool in this folder: size-limit finds its plugins through the nearest manifest. */
function runTool(script, args) {
  const cwd = import.meta.dirname;
  return run(process.execPath, [join(cwd, 'node_modules', script), ...args], { cwd });
}

/** Runs a program at the repository's root. Resolves with its exit status and its output. */
function run(program, args, options = {}) {
  const child = spawn(program, args, {
    cwd: repositoryRoot,
    env: { ...process.env, FORCE_COLOR: '0' },
    ...options,
  });
  const printed = { stdout: '', stderr: '' };
  for (const stream of ['stdout', 'stderr']) {
    child[stream].setEncoding('utf8').on('data', (text) => {
      printed[stream] += text;
    });
  }
  return new Promise((resolve, reject) => {
    child.once('error', reject);
    child.once('close', (status) => resolve({ status, ...printed }));
  });
}
