// `npm run compare-checkouts -- A B`: compares images of two checkouts of this repository bit by
// bit, and their frame times. Both run alternately on this machine, so that other load affects both
// alike.
import { execFileSync } from 'node:child_process';
import {
  existsSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  realpathSync,
  rmSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { compareImages, ratioLines, ratioTable, timeRatios } from './compare-results.mjs';
import { commitOf, evidenceOf } from './evidence.mjs';

const USAGE = `npm run compare-checkouts -- A B [--keep DIR] [render SCENE … --camera CAM.json --size WxH [OPTION…]]
npm run compare-checkouts -- A B [--rounds N] [--evidence FILE] bench SCENE|--synthetic N [OPTION…]
  A, B          folders of this repository with their packages (npm ci)
  render, bench commands of websplatter with their options, run in both; without a command, every effect, preset and
                setting and sheared clouds are drawn
  --keep DIR    keeps the images there, raw float32, in a and b
  --rounds N    how often each is measured; default 6
  --evidence FILE
                writes the times as evidence for the documentation, to be given a title and a conclusion
Ends with 0 where all images are identical, 1 where any differs, 2 where nothing could be compared.`;

const DRAW_CASES = fileURLToPath(new URL('draw-cases.mjs', import.meta.url));

try {
  process.exitCode = main(process.argv.slice(2));
} catch (error) {
  console.error(error.message);
  process.exitCode = 2;
}

function main(args) {
  const at = args.findIndex((arg) => arg === 'render' || arg === 'bench');
  const [own, command] = at < 0 ? [args, []] : [args.slice(0, at), args.slice(at)];
  const { checkouts, keep, rounds, evidence } = readOptions(own);
  for (const [i, folder] of checkouts.entries())
    console.log(`${'AB'[i]}: ${folder}, ${commitOf(folder) ?? 'no commit'}`);
  return command[0] === 'bench'
    ? compareTimes(checkouts, command, rounds, evidence)
    : comparePictures(checkouts, command, keep);
}

function readOptions(args) {
  try {
    const string = { type: 'string' };
    const options = { keep: string, evidence: string, rounds: { ...string, default: '6' } };
    const { values, positionals } = parseArgs({ args, options, allowPositionals: true });
    if (positionals.length !== 2) throw new Error(`Give two folders; there are ${positionals.length}.`);
    const rounds = Number(values.rounds);
    if (!(Number.isInteger(rounds) && rounds >= 1))
      throw new Error(`--rounds is ${values.rounds}; give a whole number from 1 on.`);
    const [keep, evidence] = [values.keep, values.evidence].map((path) => path && resolve(path));
    return { checkouts: positionals.map(findCheckout), keep, evidence, rounds };
  } catch (error) {
    throw new Error(`${error.message}\n${USAGE}`);
  }
}

/** The real path of a checkout with built packages. */
function findCheckout(path) {
  const folder = existsSync(path) ? realpathSync(path) : resolve(path);
  const linked = join(folder, 'node_modules/@websplatter/core');
  // Borrowed node_modules would run the packages of another checkout.
  if (!existsSync(linked) || realpathSync(linked) !== join(folder, 'packages/core'))
    throw new Error(`${linked} does not lead to packages/core of that checkout: run npm ci there first.`);
  // Copies of built files lack the tools.
  const build = join(folder, 'packages/tools/build.mjs');
  if (existsSync(build)) execFileSync(process.execPath, [build, '--packages'], { stdio: 'inherit' });
  return folder;
}

function websplatter(folder, args) {
  const bin = join(folder, 'packages/cli/bin/websplatter.js');
  return execFileSync(process.execPath, [bin, ...args], {
    encoding: 'utf8',
    maxBuffer: 2 ** 28,
    // Progress messages appear only in an error.
    stdio: 'pipe',
  });
}

function comparePictures(checkouts, command, keep) {
  const into = keep ?? mkdtempSync(join(tmpdir(), 'websplatter-compare-'));
  try {
    const drawn = checkouts.map((checkout, i) => {
      const folder = join(into, 'ab'[i]);
      mkdirSync(folder, { recursive: true });
      if (command.length > 0) websplatter(checkout, [...command, '--raw', join(folder, 'image.f32')]);
      else execFileSync(process.execPath, [DRAW_CASES, checkout, folder], { stdio: 'inherit' });
      return folder;
    });
    const names = [...new Set(drawn.flatMap((folder) => readdirSync(folder)))].sort();
    const rows = names.map((name) => ({
      name,
      ...compareImages(...drawn.map((folder) => readImage(folder, name))),
    }));
    for (const { name, finding } of rows) console.log(`${name}  ${finding}`);
    const wrong = rows.filter(({ isSame }) => !isSame).length;
    console.log(
      wrong === 0
        ? `\nIdentical: ${rows.length} images.`
        : `\nNOT identical: ${wrong} of ${rows.length} images.`,
    );
    return wrong === 0 ? 0 : 1;
  } finally {
    if (!keep) rmSync(into, { recursive: true, force: true });
  }
}

/** Null if the image was not drawn. */
function readImage(folder, name) {
  const file = join(folder, name);
  return existsSync(file) ? new Float32Array(Uint8Array.from(readFileSync(file)).buffer) : null;
}

function compareTimes(checkouts, command, rounds, evidenceFile) {
  const measured = checkouts.map(() => []);
  for (let round = 0; round < rounds; round++) {
    // Alternates the order, so that a machine that slows down affects both alike.
    for (const i of round % 2 === 0 ? [0, 1] : [1, 0])
      measured[i].push(JSON.parse(websplatter(checkouts[i], [...command, '--json'])).measurement);
  }
  const { adapter } = measured[0][0];
  console.log(`${adapter}; ${rounds} rounds in turns; ms, medians of the rounds, and B beside A\n`);
  const found = timeRatios(...measured);
  for (const line of ratioLines(found)) console.log(line);
  if (evidenceFile) {
    const commits = checkouts.map((folder) => commitOf(folder) ?? 'unknown').join(' and ');
    const run = { command: `compare-checkouts ${command.join(' ')}`, commit: commits, adapter };
    const table = ratioTable(found, `Medians of ${rounds} rounds in turns, and ratios of each round`);
    writeFileSync(evidenceFile, `${JSON.stringify(evidenceOf(run, [table]), null, 2)}\n`);
  }
  return 0;
}
