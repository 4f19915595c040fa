// `npm run evidence -- FILE bench|accuracy …`: runs that command of websplatter, and writes what it
// measured as evidence for the documentation.
import { execFileSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { accuracyTables, benchTables, commitOf, evidenceOf } from './evidence.mjs';
import { ensureInstalled, fail, repositoryRoot } from './setup.mjs';

const USAGE = `npm run evidence -- FILE bench SCENE|--synthetic N [OPTION…]
npm run evidence -- FILE accuracy SCENE… [OPTION…]
  FILE             evidence/NAME.json, to be given a title and a conclusion
  bench, accuracy  commands of websplatter with their options`;

const tablesOf = { bench: benchTables, accuracy: accuracyTables };
const [file, ...args] = process.argv.slice(2);
if (file === '--help') {
  console.log(USAGE);
  process.exit(0);
}
if (file === undefined || !Object.hasOwn(tablesOf, args[0] ?? '')) fail(USAGE);
ensureInstalled();
const program = join(repositoryRoot, 'packages/cli/bin/websplatter.js');
const cwd = process.env.INIT_CWD ?? process.cwd();
let printed;
try {
  printed = execFileSync(process.execPath, [program, ...args, '--json'], {
    ...{ cwd, encoding: 'utf8', maxBuffer: 2 ** 28 },
    stdio: ['inherit', 'pipe', 'inherit'],
  });
} catch {
  fail(`websplatter ${args[0]} failed; ${file} was not written.`);
}
const report = JSON.parse(printed);
const { adapter, notes } = report.measurement ?? report;
const run = { command: `websplatter ${args.join(' ')}`, commit: commitOf(repositoryRoot), adapter };
const evidence = evidenceOf(run, tablesOf[args[0]](report), notes);
writeFileSync(resolve(cwd, file), `${JSON.stringify(evidence, null, 2)}\n`);
