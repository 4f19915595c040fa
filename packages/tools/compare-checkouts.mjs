// `npm run compare-checkouts -- A B`: whether two checkouts of this repository draw the same images, bit by bit. The cases are
// those of the checkout that this runs from; only the built packages of A and B are used.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { describeCheckout, findCheckout } from './checkouts/checkout.mjs';
import { compareDrawn } from './checkouts/compare-drawn.mjs';
import { readDrawnFolder } from './checkouts/drawn-folder.mjs';

const USAGE = `npm run compare-checkouts -- A B [OPTION…]
  A, B            folders with built packages (npm run build); node_modules and .git are not needed with --dawn
  --cases NAMES   only these, separated by commas: groups (effects) or cases (effects/fog)
  --size WxH      size of the images, px; default 96x64
  --playbot FILE  a captured scene to draw, too
  --dawn FILE     the dawn.node of npm's webgpu, for folders without node_modules
  --keep DIR      keep the images there, raw float32, in a and b
Ends with 0 where all is identical, 1 where anything differs, fails or is missing, 2 where it could not be compared.`;

const DRAW_CASES = fileURLToPath(new URL('checkouts/draw-cases.mjs', import.meta.url));

const options = readOptions();
const into = options.keep ?? mkdtempSync(join(tmpdir(), 'websplatter-compare-'));
if (!options.keep) process.on('exit', () => rmSync(into, { recursive: true, force: true }));

const drawn = [];
for (const [i, { path, folder }] of options.checkouts.entries()) {
  const letter = 'AB'[i];
  console.log(`${letter}: ${path}, ${describeCheckout({ folder })}`);
  const target = join(into, letter.toLowerCase());
  const startMs = performance.now();
  // One after the other: two at a time would share one GPU, or the cores that stand in for it.
  await draw({ ...options.drawing, folder, into: target }).catch((error) =>
    stop(`${path}: ${error.message}`),
  );
  drawn.push(readDrawnFolder(target));
  const seconds = ((performance.now() - startMs) / 1000).toFixed(0);
  console.log(`   drawn in ${seconds} s on ${drawn[i].adapter}, Node ${drawn[i].node}`);
}
const [a, b] = drawn;
if (a.adapter !== b.adapter) stop(`The adapters differ: ${a.adapter} and ${b.adapter}.`);
const rows = compareDrawn(a.outputs, b.outputs);
if (rows.length === 0) stop(`There are no cases named ${options.drawing.names.join(', ')}.`);
printTable(rows);
printNotes(a.notes, b.notes);
const wrong = rows.filter(({ isSame }) => !isSame).length;
const skipped = rows.filter(({ finding }) => finding.startsWith('skipped')).length;
const of = `${rows.length} outputs${skipped > 0 ? `, ${skipped} of them skipped` : ''}`;
console.log(wrong === 0 ? `\nIdentical: ${of}.` : `\nNOT identical: ${wrong} of ${of}.`);
process.exit(wrong === 0 ? 0 : 1);

function readOptions() {
  try {
    const string = { type: 'string' };
    const { values, positionals } = parseArgs({
      allowPositionals: true,
      options: {
        cases: { type: 'string', multiple: true, default: [] },
        size: { type: 'string', default: '96x64' },
        playbot: string,
        dawn: string,
        keep: string,
      },
    });
    if (positionals.length !== 2)
      throw new Error(`Two folders are to be compared; there are ${positionals.length}.`);
    const [, width, height] = /^(\d+)x(\d+)$/.exec(values.size) ?? [];
    // Some cases draw a few pixels less than this.
    if (!(width >= 32 && height >= 32)) throw new Error(`--size is ${values.size}; give WxH, from 32x32 on.`);
    const checkouts = positionals.map(findCheckout);
    return {
      checkouts,
      keep: values.keep && resolve(values.keep),
      drawing: {
        names: values.cases.flatMap((names) => names.split(',')).filter(Boolean),
        size: { widthPx: Number(width), heightPx: Number(height) },
        dawn: values.dawn ? resolve(values.dawn) : null,
        // One file for both.
        playbot: values.playbot ? resolve(values.playbot) : null,
      },
    };
  } catch (error) {
    return stop(`${error.message}\n${USAGE}`);
  }
}

function draw(drawing) {
  const child = spawn(process.execPath, [DRAW_CASES, JSON.stringify(drawing)], {
    stdio: ['ignore', 'inherit', 'inherit'],
  });
  return new Promise((resolve, reject) => {
    child.once('error', reject);
    child.once('exit', (status, signal) => {
      if (status === 0) resolve();
      else reject(new Error(`drawing ended with ${signal ?? `status ${status}`}.`));
    });
  });
}

function printTable(rows) {
  const nameWidth = Math.max(...rows.map(({ name }) => name.length));
  for (const { name, size, finding, largest, psnrDb } of rows) {
    const amount =
      largest === undefined ? '' : `, by at most ${largest.toPrecision(3)}, PSNR ${psnrDb.toFixed(1)} dB`;
    console.log(`${name.padEnd(nameWidth)}  ${size.padStart(7)}  ${finding}${amount}`);
  }
}

/** Those that differ: they may. */
function printNotes(notesA, notesB) {
  const inB = new Map(notesB.map(({ name, value }) => [name, JSON.stringify(value)]));
  for (const { name, value } of notesA) {
    const [textA, textB] = [JSON.stringify(value), inB.get(name)];
    if (textA !== textB) console.log(`note: ${name}: ${textA} → ${textB}`);
  }
}

function stop(message) {
  console.error(message);
  process.exit(2);
}
