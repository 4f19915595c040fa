// Proves: large files are described, converted and drawn in float64 in bounded memory.
import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { appendFileSync, createReadStream, readFileSync } from 'node:fs';
import { pipeline } from 'node:stream/promises';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { TestFolder } from './testing/test-folder.ts';

const bin = fileURLToPath(new URL('../bin/websplatter.js', import.meta.url));
/** More than `convert` holds, 2²⁸ bytes. */
const FILE_BYTES = 272e6;
const ROWS_AT_ONCE = 1 << 14;
/** Node itself takes a third of it. A file in memory would take twice as much. */
const MOST_BYTES = 200e6;

/** The splats of a small PLY over and over; returns their number. */
function writeLargePly(folder: TestFolder, name: string): number {
  const small = readFileSync(folder.scene('small.ply'));
  const start = small.indexOf('end_header\n') + 'end_header\n'.length;
  const block = Buffer.concat(Array.from({ length: ROWS_AT_ONCE }, () => small.subarray(start)));
  const blocks = Math.ceil(FILE_BYTES / block.length);
  const count = 3 * ROWS_AT_ONCE * blocks;
  folder.write(name, small.toString('latin1', 0, start).replace('vertex 3', `vertex ${count}`));
  for (let i = 0; i < blocks; i++) appendFileSync(folder.file(name), block);
  return count;
}

/** Runs the program, and adds the most memory that it has had. */
function websplatter(folder: TestFolder, ...args: string[]) {
  return websplatterIn(folder, [], ...args);
}

/** The same with options of Node. */
function websplatterIn(folder: TestFolder, options: readonly string[], ...args: string[]) {
  // Not resourceUsage, which counts the memory of this process before the program took its place.
  const status = 'require("node:fs").readFileSync("/proc/self/status", "utf8")';
  const meter = `process.on("exit", () => console.error(/^VmHWM.*$/m.exec(${status})[0]))`;
  const meterFile = folder.write('meter.cjs', meter);
  const ended = spawnSync(process.execPath, [...options, '--require', meterFile, bin, ...args], {
    cwd: folder.path,
    encoding: 'utf8',
  });
  return { ...ended, peakBytes: 1024 * Number(/^VmHWM:\s+(\d+) kB$/m.exec(ended.stderr)?.[1]) };
}

async function digestOf(path: string): Promise<string> {
  const hash = createHash('sha256');
  await pipeline(createReadStream(path), hash);
  return hash.digest('hex');
}

/**
 * @fault Files: a PLY, `.splat` or SPZ on the command line is larger than memory
 * @consequence `info` describes it and `convert` makes PLY and SPZ of it, in 200 MB and, for SPZ, at most
 *   256 MiB more
 */
test.skipIf(process.platform !== 'linux')(
  'a scene that is larger than the memory is described and converted',
  async () => {
    const folder = new TestFolder();
    const count = writeLargePly(folder, 'large.ply');
    const described = websplatter(folder, 'info', 'large.ply', '--json');
    expect(described.status).toBe(0);
    expect(JSON.parse(described.stdout)).toMatchObject({
      count,
      bounds: { min: [-1, 0, 0], max: [1, 0, 0.5] },
      shBands: [{ band: 1, rms: expect.closeTo(0.5, 9) }],
    });
    expect(described.peakBytes).toBeLessThan(MOST_BYTES);
    for (const out of ['same.ply', 'small.spz']) {
      const converted = websplatter(folder, 'convert', 'large.ply', out);
      expect(converted).toMatchObject({
        status: 0,
        stdout: expect.stringContaining(count.toLocaleString('en')),
      });
      // Of SPZ all attributes but the first are held, 20 bytes of a splat.
      const heldBytes = out.endsWith('.spz') ? 20 * count : 0;
      expect(converted.peakBytes, out).toBeLessThan(MOST_BYTES + heldBytes);
    }
    const edits = ['--translate', '1,0,0', '--crop', '1.5,0,0,3,1,1', '--sh', '0'];
    expect(websplatter(folder, 'convert', 'large.ply', 'edited.ply', ...edits).status).toBe(0);
    expect(JSON.parse(websplatter(folder, 'info', 'edited.ply', '--json').stdout)).toMatchObject({
      ...{ count: count / 3, shDegree: 0, bounds: { min: [2, 0, 0], max: [2, 0, 0] } },
    });
    const none = websplatter(folder, 'convert', 'large.ply', 'none.ply', '--crop', '5,5,5,6,6,6');
    expect(none.stderr).toContain(`websplatter: None of ${count} splats is between 5, 5, 5 and 6, 6, 6.`);
    expect(await digestOf(folder.file('same.ply'))).toBe(await digestOf(folder.file('large.ply')));
    const packed = websplatter(folder, 'info', 'small.spz', '--json');
    expect(JSON.parse(packed.stdout)).toMatchObject({ count, shDegree: 1 });
    expect(packed.peakBytes).toBeLessThan(MOST_BYTES);
  },
);

/** Splats that a kilobyte each would not fit `HEAP_MB`. */
const DRAWN_SPLATS = 150_000;
const HEAP_MB = 80;
/** Of values of the file, the order and the image, besides Node. */
const DRAWN_BYTES_EACH = 220;

/**
 * @fault Command line: `render --renderer reference` draws millions of splats
 * @consequence drawn in bounded memory, though an object each does not fit the heap; a line per ten
 *   percent shows progress
 */
test.skipIf(process.platform !== 'linux')(
  'the reference renderer draws many splats in a small heap, and tells how far it is',
  () => {
    const folder = new TestFolder();
    const small = readFileSync(folder.scene('small.ply'));
    const start = small.indexOf('end_header\n') + 'end_header\n'.length;
    const rows = Buffer.concat(Array.from({ length: DRAWN_SPLATS / 3 + 1 }, () => small.subarray(start)));
    const count = 3 * (Math.floor(DRAWN_SPLATS / 3) + 1);
    folder.write('many.ply', small.toString('latin1', 0, start).replace('vertex 3', `vertex ${count}`));
    appendFileSync(folder.file('many.ply'), rows);
    const drawn = websplatterIn(
      folder,
      [`--max-old-space-size=${HEAP_MB}`],
      ...['render', 'many.ply', '--camera', folder.camera(), '--size', '24x16'],
      ...['--renderer', 'reference', '--raw', 'many.f32'],
    );
    expect(drawn).toMatchObject({
      status: 0,
      stdout: expect.stringContaining(`${count} of ${count} splats`),
      stderr: expect.stringMatching(/^0 %: drawing in float64\n10 %.*\n(\d+ %.*\n)+90 %/),
    });
    expect(drawn.peakBytes).toBeLessThan(MOST_BYTES + DRAWN_BYTES_EACH * count);
  },
);
