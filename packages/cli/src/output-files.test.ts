import { execFileSync } from 'node:child_process';
import { once } from 'node:events';
import { chmodSync, linkSync, lstatSync, readdirSync, readFileSync, statSync, symlinkSync } from 'node:fs';
import { mkdir, readFile } from 'node:fs/promises';
import { createServer } from 'node:net';
import { basename, dirname, join } from 'node:path';
import { beforeEach, describe, expect, test } from 'vitest';
import { checkOutputs, noteLeftOutputs, writeFiles } from './output-files.ts';
import { partPath } from './part-names.ts';
import { TestFolder } from './testing/test-folder.ts';

let folder: TestFolder;
beforeEach(() => {
  folder = new TestFolder();
});

const out = (path: string) => ({ argument: '--out', path });
const write = (path: string, content: string) => writeFiles([{ ...out(path), content }], []);

test('files are written whole, over older ones, with nothing left beside them', async () => {
  const path = folder.file('a.txt');
  await write(path, 'old');
  await write(path, 'new');
  expect(readFileSync(path, 'utf8')).toBe('new');
  expect(readdirSync(folder.path)).toEqual(['a.txt']);
});

test('where one file cannot be written none is', async () => {
  const path = folder.file('missing/b.txt');
  const files = [folder.file('a.txt'), path].map((each) => ({ ...out(each), content: 'a' }));
  await expect(writeFiles(files, [])).rejects.toThrow(
    `${path}: cannot be written: there is no such file or folder`,
  );
  expect(readdirSync(folder.path)).toEqual([]);
});

/**
 * @fault Command line: two runs with one process id write to one folder, as in two containers
 * @consequence both results are there
 */
test('runs with one process id, as in two containers, leave each other alone', async () => {
  const path = folder.file('a.txt');
  const theirs = folder.write(`.a.txt.${process.pid}.part`, 'theirs');
  const both = [folder.file('b.txt'), folder.file('b.txt')].map((each) => write(each, 'whole'));
  await Promise.all([write(path, 'mine'), ...both]);
  expect(readFileSync(path, 'utf8')).toBe('mine');
  expect(readFileSync(folder.file('b.txt'), 'utf8')).toBe('whole');
  expect(readFileSync(theirs, 'utf8')).toBe('theirs');
  expect(readdirSync(folder.path).sort()).toEqual([basename(theirs), 'a.txt', 'b.txt'].sort());
});

/**
 * @fault Command line: an output has a name of 241 to 255 bytes, or a longer one
 * @consequence written; a longer one gives one line before the work, exit status 2
 */
test('a name may have as many bytes as the system allows, and one more is refused beforehand', async () => {
  for (const bytes of [241, 255]) {
    const path = folder.file('n'.repeat(bytes));
    await checkOutputs([out(path)], []);
    await write(path, 'whole');
    expect(readFileSync(path, 'utf8')).toBe('whole');
  }
  await expect(checkOutputs([out(folder.file('n'.repeat(256)))], [])).rejects.toThrow(
    'cannot be written: the name or the path is longer than the system allows',
  );
});

/**
 * @fault Command line: a run is killed while it writes
 * @consequence its incomplete file stays, and the next run names it in a note; no file of another run is
 *   removed
 */
test('incomplete files of killed runs are told of, and kept', async () => {
  const notesOf = async () => {
    let notes = '';
    const console = { out: () => {}, err: (text: string) => (notes += text) };
    await noteLeftOutputs([out(folder.file('a.txt')), out(folder.file('b.txt'))], console);
    return notes;
  };
  folder.write('.other.part', 'not ours');
  // The parent of this process is alive, and may be writing.
  const [own, alive] = [process.pid, process.ppid].map((pid) => {
    const path = partPath(folder.path);
    return path.replace(`-${process.pid}-`, `-${pid}-`);
  });
  folder.write(basename(alive), 'at work');
  expect(await notesOf()).toBe('');
  const elsewhere = partPath(folder.path).replace('.websplatter-', '.websplatter-another-');
  folder.write(basename(own), 'killed');
  folder.write(basename(elsewhere), 'killed');
  const note = await notesOf();
  expect(note).toMatch(/^note: \S+ has 2 incomplete files of runs that were killed [^\n]+; remove [^\n]+\n$/);
  expect(note).toContain('; 12 bytes');
  for (const path of [own, elsewhere]) expect(note).toContain(basename(path));
  expect(readdirSync(folder.path)).toHaveLength(4);
});

/** @fault Command line: a scene, or an output, is a socket; a scene is a terminal */
test('a path that cannot become a file is refused beforehand', async () => {
  const check = (path: string) => checkOutputs([out(path)], []);
  await expect(check(folder.path)).rejects.toThrow('it is a folder');
  await expect(check(folder.file('no/a.png'))).rejects.toThrow(`(folder ${folder.file('no')})`);
  await expect(check(folder.file('a.png'))).resolves.toBeUndefined();
  if (process.platform === 'win32') return;
  const server = createServer().listen(folder.file('socket'));
  await once(server, 'listening');
  await expect(check(folder.file('socket'))).rejects.toThrow('it is a socket');
  server.close();
});

/**
 * @fault Command line: an output is a link, or has a mode or an owner of its own
 * @consequence the link is followed; mode and owner are kept
 */
describe.skipIf(process.platform === 'win32')('an output that is there', () => {
  test('keeps its mode', async () => {
    const path = folder.write('secret.txt', 'old');
    chmodSync(path, 0o600);
    await write(path, 'new');
    expect(statSync(path).mode & 0o777).toBe(0o600);
    expect(readFileSync(path, 'utf8')).toBe('new');
  });

  test.skipIf(process.getuid?.() !== 0)('keeps its owner', async () => {
    const path = folder.write('theirs.txt', 'old');
    execFileSync('chown', ['1234:1235', path]);
    await write(path, 'new');
    expect(statSync(path)).toMatchObject({ uid: 1234, gid: 1235 });
  });

  test('is written where a link leads, and the link stays', async () => {
    await mkdir(folder.file('there'));
    const target = folder.write('there/a.txt', 'old');
    const links = ['relative', 'of a link', 'to nothing yet'].map(folder.file, folder);
    symlinkSync('there/a.txt', links[0]);
    symlinkSync('relative', links[1]);
    symlinkSync('there/new.txt', links[2]);
    for (const link of links) {
      await write(link, link);
      expect(lstatSync(link).isSymbolicLink()).toBe(true);
      expect(readFileSync(link, 'utf8')).toBe(link);
    }
    expect(readFileSync(target, 'utf8')).toBe(links[1]);
    expect(readdirSync(dirname(target)).sort()).toEqual(['a.txt', 'new.txt']);
  });

  test('is written into if it is a pipe, after all files are whole', async () => {
    const pipe = folder.file('pipe');
    execFileSync('mkfifo', [pipe]);
    const read = readFile(pipe, 'utf8');
    const files = [pipe, folder.file('a.txt')].map((path) => ({ ...out(path), content: 'whole' }));
    await writeFiles(files, []);
    expect(await read).toBe('whole');
    expect(statSync(pipe).isFIFO()).toBe(true);
    expect(readdirSync(folder.path).sort()).toEqual(['a.txt', 'pipe']);
  });
});

/**
 * @fault Command line: an output is also an input, or another output, by any name
 * @consequence one line that names it, exit status 2; nothing is written
 */
test('an output that is read, or another output, by any name is refused', async () => {
  const scene = folder.write('scene.ply', 'scene');
  await mkdir(folder.file('sub'));
  const names = {
    same: scene,
    dotted: join(folder.path, 'sub', '..', 'scene.ply'),
    soft: folder.file('soft.ply'),
    hard: folder.file('hard.ply'),
    'in a linked folder': folder.file('linked/scene.ply'),
  };
  symlinkSync('scene.ply', names.soft);
  linkSync(scene, names.hard);
  symlinkSync('.', folder.file('linked'));
  for (const path of Object.values(names)) {
    const refused = `--out is ${path}, which is read too; give it another name`;
    await expect(checkOutputs([out(path)], ['cam.json', scene])).rejects.toThrow(refused);
    await expect(writeFiles([{ ...out(path), content: 'x' }], [scene])).rejects.toThrow(refused);
    const both = [out(scene), { argument: '--raw', path }];
    await expect(checkOutputs(both, [])).rejects.toThrow(`--raw is ${path}, which --out writes too`);
  }
  expect(readFileSync(scene, 'utf8')).toBe('scene');
  const newNames = [out(folder.file('new')), { argument: '--raw', path: folder.file('linked/new') }];
  await expect(checkOutputs(newNames, [])).rejects.toThrow('which --out writes too');
  await expect(checkOutputs([], ['-', '-'])).rejects.toThrow('standard input, -, can be read only once');
});
