// `npm run check:packages`: packs the published packages and checks the tarballs. publint and attw must report nothing,
// not even suggestions; README and LICENSE must be there; sizes must stay within .size-limit.json.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { publint } from 'publint';
import { formatMessage } from 'publint/utils';
import { PUBLISHED, pack } from './pack.mjs';
import { fail, repositoryRoot } from './setup.mjs';

const folder = mkdtempSync(join(tmpdir(), 'websplatter-packages-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

const packed = await pack(folder).catch((error) => fail(error.stderr || error.message));
const problems = (
  await Promise.all([
    ...PUBLISHED.map(missingFiles),
    ...packed.map(({ tarball }) => publintProblems(tarball)),
    // One after the other, since each occupies a core.
    attwProblems(packed.map(({ tarball }) => tarball)),
    sizeProblems(),
  ])
).flat();
for (const problem of problems) console.error(problem);
if (problems.length > 0) fail(`\n${problems.length} package checks failed.`);
console.log(`publint and attw report nothing for ${packed.map(({ name }) => name).join(', ')}.`);

function missingFiles(name) {
  const path = (file) => join(repositoryRoot, 'packages', name, file);
  const missing = [];
  if (!existsSync(path('README.md'))) missing.push(`packages/${name}: README.md is missing`);
  const license = readFileSync(join(repositoryRoot, 'LICENSE'), 'utf8');
  if (!existsSync(path('LICENSE')) || readFileSync(path('LICENSE'), 'utf8') !== license)
    missing.push(`packages/${name}: LICENSE is not a copy of the repository's`);
  return missing;
}

async function publintProblems(tarball) {
  const { messages, pkg } = await publint({
    pack: { tarball: new Uint8Array(readFileSync(tarball)).buffer },
    level: 'suggestion',
    strict: true,
  });
  return messages.map((message) => `publint, ${pkg.name}: ${formatMessage(message, pkg)}`);
}

async function attwProblems(tarballs) {
  const problems = [];
  for (const tarball of tarballs) {
    const args = [tarball, '--profile', 'esm-only', '--format', 'ascii', '--no-color', '--no-emoji'];
    const { status, output } = await runNode('@arethetypeswrong/cli/dist/index.js', args);
    if (status !== 0) problems.push(`attw, ${basename(tarball)}:\n${output}`);
  }
  return problems;
}

async function sizeProblems() {
  const { status, output } = await runNode('size-limit/bin.js', []);
  if (status !== 0) return [`size-limit:\n${output}`];
  console.log(output);
  return [];
}

/** Runs a tool of node_modules at the repository's root and returns its stdout, and its stderr if it fails. */
function runNode(script, args) {
  const child = spawn(process.execPath, [join(repositoryRoot, 'node_modules', script), ...args], {
    cwd: repositoryRoot,
    env: { ...process.env, FORCE_COLOR: '0' },
  });
  const printed = { stdout: '', stderr: '' };
  for (const stream of ['stdout', 'stderr']) {
    child[stream].setEncoding('utf8').on('data', (text) => {
      printed[stream] += text;
    });
  }
  return new Promise((resolve, reject) => {
    child.once('error', reject);
    child.once('close', (status) => {
      const output = status === 0 ? printed.stdout : printed.stdout + printed.stderr;
      resolve({ status, output: output.trimEnd() });
    });
  });
}
