// Sums up the lines that measure-costs.ts writes: CPU seconds of each file and test, the dearest first.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';

const KINDS = ['total', 'setUp', 'compile', 'draw', 'browserGpu'];
const NOTHING = { tests: 0, ...Object.fromEntries(KINDS.map((kind) => [kind, 0])) };
/** Characters of a column: its heading and a space. */
const WIDTH = 11;
/** Tests below this are left out of the list of tests. */
const LEAST_TEST_S = 0.1;

/**
 * Returns the CPU seconds of each file and of each test. Imports, devices, browsers and servers between two
 * tests are the set-up of the later one's file. `startS` is what was spent before the first test.
 *
 * @param {readonly object[]} lines In the order in which the tests ran.
 */
export function costsOf(lines) {
  const files = new Map();
  const tests = [];
  let before = { totalMs: 0, browserGpuMs: 0 };
  let startS = 0;
  for (const { project, file, test, begun, ended } of lines) {
    const key = `${project} ${file}`;
    const setUp = Math.max(0, begun.totalMs - before.totalMs) / 1000;
    const first = before.totalMs === 0;
    if (first) startS = setUp;
    const spent = (name) => Math.max(0, ended[name] - begun[name]) / 1000;
    const total = spent('totalMs');
    const costs = {
      total,
      compile: spent('compileMs'),
      draw: spent('drawMs'),
      browserGpu: spent('browserGpuMs'),
    };
    const row = files.get(key) ?? { project, file, ...NOTHING };
    row.tests++;
    for (const kind of Object.keys(costs)) row[kind] += costs[kind];
    if (!first) {
      row.setUp += setUp;
      row.total += setUp;
    }
    files.set(key, row);
    tests.push({ project, file, test, ...costs });
    before = ended;
  }
  const byCost = (a, b) => b.total - a.total;
  return { startS, files: [...files.values()].sort(byCost), tests: tests.sort(byCost) };
}

/** The costs as text: projects, files and tests, in CPU seconds. */
export function costTable({ startS, files, tests }) {
  const number = (seconds) => seconds.toFixed(1).padStart(WIDTH);
  const head = `${KINDS.map((kind) => kind.padStart(WIDTH)).join('')}   tests  `;
  const line = (row, count, name) =>
    `${KINDS.map((kind) => (kind in row ? number(row[kind]) : ' '.repeat(WIDTH))).join('')}${String(count).padStart(8)}  ${name}`;
  const projects = new Map();
  for (const row of files) {
    const sum = projects.get(row.project) ?? { ...NOTHING };
    for (const kind of [...KINDS, 'tests']) sum[kind] += row[kind];
    projects.set(row.project, sum);
  }
  const all = files.reduce((sum, { total }) => sum + total, startS);
  return [
    `CPU seconds, user and system, of all processes of the run: ${all.toFixed(0)}, of which ${startS.toFixed(0)} before the first test.`,
    'setUp: between tests; compile, draw: Dawn in Node; browserGpu: GPU processes of browsers. Parts of total.',
    '',
    `${head}project`,
    ...[...projects]
      .sort(([, a], [, b]) => b.total - a.total)
      .map(([name, row]) => line(row, row.tests, name)),
    '',
    `${head}file`,
    ...files.map((row) => line(row, row.tests, `${row.project} ${row.file}`)),
    '',
    `${head}test, of ${LEAST_TEST_S} s and more`,
    ...tests
      .filter(({ total }) => total >= LEAST_TEST_S)
      .map((row) => line(row, '', `${row.project} ${row.file} > ${row.test}`)),
    '',
  ].join('\n');
}

/** Writes the table of the lines in `linesPath` to `path`. */
export function writeCostTable(linesPath, path) {
  if (!existsSync(linesPath)) return;
  const lines = readFileSync(linesPath, 'utf8')
    .trim()
    .split('\n')
    .map((line) => JSON.parse(line));
  writeFileSync(path, costTable(costsOf(lines)));
  console.log(`CPU seconds per file and test: ${path}`);
}
