// Proves: commands as processes: drivers that fail, readers that leave, full disks.
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import {
  existsSync,
  lstatSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  readlinkSync,
  statSync,
  symlinkSync,
} from 'node:fs';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

const bin = fileURLToPath(new URL('../bin/websplatter.js', import.meta.url));
const isBuilt = existsSync(new URL('../dist/main.js', import.meta.url));

/** Runs the program as users do, from the output of `npm run build`. `npm test` builds first. */
const binTest = test.skipIf(!isBuilt && !process.env.CI);
/** The same where there are pipes and signals as in Unix. */
const unixTest = test.skipIf((!isBuilt && !process.env.CI) || process.platform === 'win32');

function websplatter(...args: string[]) {
  return websplatterIn({}, ...args);
}

/** Runs it with other environment variables; undefined ones are removed. */
function websplatterIn(variables: Record<string, string | undefined>, ...args: string[]) {
  const env = { ...process.env, WEBSPLATTER_DEBUG: undefined, ...variables };
  const { status, stdout, stderr } = spawnSync(process.execPath, [bin, ...args], { encoding: 'utf8', env });
  return { status, stdout, stderr };
}

/** Runs a line of a shell, in which `$0 "$1"` is the program. */
function shell(command: string, cwd?: string) {
  return spawnSync('bash', ['-c', command, process.execPath, bin], { encoding: 'utf8', cwd });
}

/** Names of incomplete files that hold something: an empty one may be a trial, made and removed at the start. */
function partsBeingWritten(folder: TestFolder): string[] {
  return readdirSync(folder.path).filter(
    (name) => name.endsWith('.part') && statSync(folder.file(name)).size > 0,
  );
}

binTest('--help lists the commands that exist', () => {
  const { status, stdout, stderr } = websplatter('--help');
  expect([status, stderr]).toEqual([0, '']);
  expect(stdout).toContain('websplatter render SCENE');
  expect(stdout).toContain('websplatter info SCENE');
  expect(stdout).toContain('websplatter convert IN');
  expect(stdout).toContain('websplatter accuracy SCENE');
  expect(stdout).toContain('websplatter bench SCENE');
});

/**
 * @fault Command line: a scene that cannot be read
 * @consequence one line, exit status 2, and no driver is opened
 */
binTest.each(['render', 'accuracy'])('%s opens no graphics driver for a bad file', (command) => {
  const folder = new TestFolder();
  const scene = folder.write('bad.ply', 'hello');
  const output = command === 'render' ? ['--out', folder.file('a.png')] : [];
  const { status, stdout, stderr } = websplatterIn(
    // The Vulkan loader, once it is asked for a driver, writes hundreds of lines.
    { VK_LOADER_DEBUG: 'all' },
    ...[command, folder.scene(), scene, '--camera', folder.camera(), '--size', '8x8', ...output],
  );
  expect([status, stdout]).toEqual([2, '']);
  expect(stderr).toMatch(/^websplatter: \S+bad\.ply: [^\n]+\n$/);
});

/**
 * @fault Command line: the reader of a command's output leaves, like `head`
 * @consequence the work goes on, and decides the exit status
 */
unixTest('work goes on without a reader of its lines, and ends quietly without one of its result', () => {
  const folder = new TestFolder();
  const scene = folder.scene();
  // A pipe that was opened for reading, too, and is not any more.
  const noReader = 'mkfifo pipe; exec 3<>pipe 4>pipe 3>&-; rm pipe;';
  const withoutReader = (command: string) => shell(`${noReader} "$0" "$1" ${command}`, folder.path);
  expect(withoutReader('--help >&4')).toMatchObject({ status: 0, stderr: '' });
  expect(withoutReader('convert scene.ply out.ply >&4 2>&4')).toMatchObject({ status: 0 });
  expect(readFileSync(folder.file('out.ply'))).toEqual(readFileSync(scene));
  expect(withoutReader('info no.ply >&4 2>&4')).toMatchObject({ status: 2 });
  const progress = /^(\d+ %: [^\n]+\n)*$/;
  expect(withoutReader('convert scene.ply - --format ply >&4')).toMatchObject({
    status: 1,
    stderr: expect.stringMatching(progress),
  });
});

/**
 * @fault Command line: the reader of the result leaves, or the disk is full
 * @consequence silence, or one line; exit status 1
 */
binTest('it ends with one line when its disk is full', ({ skip }) => {
  if (!existsSync('/dev/full')) skip('no /dev/full here');
  expect(shell('"$0" "$1" --help > /dev/full')).toMatchObject({
    status: 1,
    stderr: 'websplatter: cannot write: the disk is full\n',
  });
});

binTest('- is standard input and standard output, and the report is on standard error', () => {
  const folder = new TestFolder();
  folder.scene();
  const report = /^(\d+ %: [^\n]+\n)+-: 3 splats, [^\n]+\n$/;
  const converted = shell('"$0" "$1" convert - - --format ply < scene.ply > out.ply', folder.path);
  expect(converted).toMatchObject({ status: 0, stdout: '', stderr: expect.stringMatching(report) });
  expect(readFileSync(folder.file('out.ply'))).toEqual(readFileSync(folder.file('scene.ply')));
  folder.camera();
  const drawn = shell(
    '"$0" "$1" render scene.ply --camera - --size 8x8 --renderer reference --raw - < camera.json | wc -c',
    folder.path,
  );
  expect(drawn).toMatchObject({ status: 0, stdout: expect.stringMatching(/^ *1024\n$/) });
  expect(drawn.stderr).toMatch(/^-: 8×8, 3 of 3 splats, [^\n]+\n$/);
  const told = shell('"$0" "$1" info - --json < scene.ply', folder.path);
  expect(told).toMatchObject({ status: 0, stderr: '' });
  expect(JSON.parse(told.stdout).count).toBe(3);
});

binTest('a scene of unknown size becomes bricks on the disk, with the bytes of one in memory', async () => {
  const folder = new TestFolder();
  const [scene, whole] = [folder.scene(), folder.file('whole.bricks')];
  for (const edit of ['', '--translate 1,2,3 --scale 2 --sh 0']) {
    const expected = await runMain('convert', scene, whole, ...edit.split(' ').filter(Boolean));
    expect(expected.status, expected.err).toBe(0);
    const piped = shell(`"$0" "$1" convert - out.bricks ${edit} < scene.ply`, folder.path);
    expect(piped.status, piped.stderr).toBe(0);
    expect(readFileSync(folder.file('out.bricks'))).toEqual(readFileSync(whole));
  }
  expect(readdirSync(folder.path).sort()).toEqual(['out.bricks', 'scene.ply', 'whole.bricks']);
});

binTest('parts that were made apart become the bricks of the whole scene', async () => {
  const folder = new TestFolder();
  const count = 700;
  const column = (width: number, seed: number) =>
    Float32Array.from({ length: width * count }, (_, i) => Math.sin(seed + i * i));
  const scene = folder.scene('scene.ply', {
    ...threeSplats(),
    count,
    positions: column(3, 1),
    logScales: column(3, 2).map((value) => value - 3),
    rotations: column(4, 3),
    opacityLogits: column(1, 4),
    colorDc: column(3, 5),
    harmonics: { degree: 1, coefficients: column(9, 6) },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
  });
  const halves = ['a', 'b'].map(async (name, i) => {
    const crop = i === 0 ? '--crop=-9,-9,-9,0,9,9' : '--crop=1e-30,-9,-9,9,9,9';
    return (await runMain('convert', scene, folder.file(`${name}.ply`), crop)).status;
  });
  expect(await Promise.all(halves)).toEqual([0, 0]);
  // The size of standard input is not known, so that these are joined on the disk.
  const joined = shell('"$0" "$1" convert a.ply - all.bricks --merge < b.ply', folder.path);
  expect(joined.stdout).toContain('all.bricks: 700 splats');
  const whole = folder.file('whole.bricks');
  expect((await runMain('convert', scene, whole)).status).toBe(0);
  expect(readFileSync(folder.file('all.bricks'))).toEqual(readFileSync(whole));
});

binTest('bricks need a folder for temporary files, and something to write', () => {
  const folder = new TestFolder();
  folder.scene();
  for (const [args, message] of [
    [
      '--temp no',
      'no: cannot take temporary data: there is no such file or folder; make room, or name another',
    ],
    ['--crop=5,5,5,6,6,6', 'None of 3 splats is between 5, 5, 5 and 6, 6, 6'],
  ]) {
    const { status, stderr } = shell(`"$0" "$1" convert - out.bricks ${args} < scene.ply`, folder.path);
    expect(status).toBe(2);
    expect(stderr).toContain(message);
  }
  expect(readdirSync(folder.path)).toEqual(['scene.ply']);
});

binTest('threads that die fail the conversion in one line', () => {
  const folder = new TestFolder();
  folder.scene();
  const die = folder.write('die.cjs', "if (!require('node:worker_threads').isMainThread) process.exit(5);");
  const command = `NODE_OPTIONS="--require=${die}" "$0" "$1" convert - out.bricks < scene.ply`;
  const { status, stdout, stderr } = shell(command, folder.path);
  expect([status, stdout]).toEqual([2, '']);
  expect(stderr).toMatch(/^(\d+ %: [^\n]+\n)*websplatter: convert: a thread stopped: [^\n]+\n$/);
  expect(readdirSync(folder.path).sort()).toEqual(['die.cjs', 'scene.ply']);
});

unixTest('temporary files have no names, so that nothing is left of a killed process', async ({ skip }) => {
  if (!existsSync('/proc/self/fd')) skip('no /proc here');
  const folder = new TestFolder();
  const ply = readFileSync(folder.scene());
  const start = ply.indexOf('end_header\n') + 'end_header\n'.length;
  const child = spawn(process.execPath, [bin, 'convert', '-', folder.file('out.bricks')]);
  const ended = once(child, 'exit');
  // Some of the rows that the header promises, enough for the first piece.
  child.stdin.on('error', () => {});
  child.stdin.write(ply.toString('latin1', 0, start).replace('vertex 3', 'vertex 900000'), 'latin1');
  child.stdin.write(Buffer.concat(Array.from({ length: 20_000 }, () => ply.subarray(start))));
  const fds = `/proc/${child.pid}/fd`;
  const openFiles = () =>
    readdirSync(fds).map((fd) => {
      try {
        return readlinkSync(`${fds}/${fd}`);
      } catch {
        // The file was closed after its folder was listed.
        return '';
      }
    });
  await expect.poll(openFiles).toContainEqual(expect.stringContaining('.part (deleted)'));
  expect(readdirSync(folder.path)).toEqual(['scene.ply']);
  child.kill('SIGKILL');
  expect(await ended).toEqual([null, 'SIGKILL']);
  expect(readdirSync(folder.path)).toEqual(['scene.ply']);
});

/**
 * @fault Command line: an output is a pipe, a device, or a file that is open elsewhere, such as
 *   `/dev/stdout`
 * @consequence the output is written into, and keeps its kind
 */
unixTest('files that are open elsewhere are written into', () => {
  const folder = new TestFolder();
  const scene = readFileSync(folder.scene());
  symlinkSync('/dev/stdout', folder.file('stdout.ply'));
  const piped = shell('"$0" "$1" convert scene.ply stdout.ply | cat > piped.ply', folder.path);
  expect(piped).toMatchObject({ status: 0, stderr: expect.stringContaining('stdout.ply: 3 splats') });
  expect(readFileSync(folder.file('piped.ply'))).toEqual(scene);
  for (const to of ['stdout.ply >> log', '/dev/fd/3 --format ply 3>> log']) {
    folder.write('log', 'before,');
    expect(shell(`"$0" "$1" convert scene.ply ${to}`, folder.path)).toMatchObject({ status: 0 });
    expect(readFileSync(folder.file('log')), to).toEqual(Buffer.concat([Buffer.from('before,'), scene]));
  }
  expect(lstatSync(folder.file('stdout.ply')).isSymbolicLink()).toBe(true);
});

binTest('standard output that is read is refused', () => {
  const folder = new TestFolder();
  const scene = readFileSync(folder.scene());
  const { status, stderr } = shell('"$0" "$1" info scene.ply >> scene.ply', folder.path);
  expect(status).toBe(2);
  expect(stderr).toMatch(/^websplatter: standard output is a file that is read too [^\n]+\n$/);
  expect(readFileSync(folder.file('scene.ply'))).toEqual(scene);
});

/**
 * @fault Command line: a device without end, such as `/dev/zero`
 * @consequence one line, exit status 2
 */
unixTest('a device without end is refused in one line', () => {
  const { status, stdout, stderr } = websplatter('info', '/dev/zero');
  expect([status, stdout]).toEqual([2, '']);
  expect(stderr).toMatch(/^websplatter: \/dev\/zero: [^\n]+\n$/);
});

/**
 * @fault Command line: SIGINT, SIGTERM or SIGHUP while files are written
 * @consequence no new file is there, older files are unchanged; it ends by the signal: 130, 143, 129 to a
 *   shell
 */
unixTest.for<NodeJS.Signals>(['SIGINT', 'SIGTERM', 'SIGHUP'])(
  '%s while files are written leaves none, and ends it',
  async (signal) => {
    const folder = new TestFolder();
    const [out, pipe] = [folder.write('a.png', 'old'), folder.file('pipe')];
    // Nothing reads it, so that the command waits for ever once the image is there.
    execFileSync('mkfifo', [pipe]);
    const [scene, camera] = [folder.scene(), folder.camera()];
    const size = ['--size', '8x8', '--renderer', 'reference'];
    const args = ['render', scene, '--camera', camera, ...size, '--out', out, '--raw', pipe];
    const child = spawn(process.execPath, [bin, ...args], { stdio: 'ignore' });
    const ended = once(child, 'exit');
    await expect.poll(() => partsBeingWritten(folder)).toHaveLength(1);
    child.kill(signal);
    expect(await ended).toEqual([null, signal]);
    expect(readdirSync(folder.path).sort()).toEqual(['a.png', 'camera.json', 'pipe', 'scene.ply']);
    expect(readFileSync(out, 'utf8')).toBe('old');
  },
);

/** @fault Command line: a run is killed while it writes */
unixTest(
  'after a run that was killed while it wrote, the next one works and names what was left',
  async () => {
    const folder = new TestFolder();
    const [out, pipe] = [folder.file('a.png'), folder.file('pipe')];
    // Nothing reads it, so that the command waits for ever once the image is there.
    execFileSync('mkfifo', [pipe]);
    const size = ['--size', '8x8', '--renderer', 'reference'];
    const args = ['render', folder.scene(), '--camera', folder.camera(), ...size, '--out', out];
    const child = spawn(process.execPath, [bin, ...args, '--raw', pipe], { stdio: 'ignore' });
    const ended = once(child, 'exit');
    const left = () => partsBeingWritten(folder);
    await expect.poll(left).toHaveLength(1);
    child.kill('SIGKILL');
    expect(await ended).toEqual([null, 'SIGKILL']);
    const [part] = left();
    const { status, stderr } = websplatter(...args);
    expect(stderr).toMatch(/^note: \S+ has 1 incomplete file of runs that were killed [^\n]+\n$/);
    expect(stderr).toContain(part);
    expect(status).toBe(0);
    expect(existsSync(out)).toBe(true);
    expect(left()).toEqual([part]);
  },
);

binTest(
  'render draws on the GPU and ends; a software driver that fails, and no desktop session, add nothing to what it writes',
  () => {
    const folder = new TestFolder();
    mkdirSync(folder.file('vulkan/icd.d'), { recursive: true });
    const ICD = { api_version: '1.1.230', library_path: folder.file('none.so') };
    folder.write('vulkan/icd.d/lvp_icd.x86_64.json', { file_format_version: '1.0.0', ICD });
    const out = folder.file('a.png');
    const { status, stderr } = websplatterIn(
      { XDG_DATA_HOME: folder.path, XDG_RUNTIME_DIR: undefined },
      ...['render', folder.scene(), '--camera', folder.camera(), '--size', '32x32', '--out', out],
    );
    expect(stderr).toMatch(/^(note: [^\n]+\n)?$/);
    expect(status).toBe(0);
    expect(existsSync(out)).toBe(true);
  },
);

/**
 * @fault Command line: no graphics driver opens
 * @consequence one line, exit status 1
 */
binTest('where no driver opens, that is the one line', () => {
  const folder = new TestFolder();
  const ICD = { api_version: '1.1.230', library_path: folder.file('none.so') };
  const driver = folder.write('driver.json', { file_format_version: '1.0.0', ICD });
  const { status, stdout, stderr } = websplatterIn(
    { VK_DRIVER_FILES: driver, WEBSPLATTER_VK_ICD: driver, XDG_RUNTIME_DIR: undefined },
    ...['hardcases', '--filter', 'sort-1-keys'],
  );
  expect([status, stdout]).toEqual([1, '']);
  expect(stderr).toMatch(/^websplatter: No WebGPU adapter: [^\n]+\n$/);
});
