import { mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { encodePly, readSplats, type SplatSet } from '@websplatter/core';
import { openFrames } from '@websplatter/core/frames';
import { writeSplats } from '@websplatter/core/write';
import { describe, expect, test } from 'vitest';
import { runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

/** The three splats, moved along x. */
function frameAt(x: number): SplatSet {
  return { ...threeSplats(), positions: threeSplats().positions.map((value, i) => value + (i % 3 ? 0 : x)) };
}

/** Writes frames into a folder, by the names of their files. */
function framesIn(folder: TestFolder, frames: Readonly<Record<string, SplatSet>>, name = 'frames'): string {
  mkdirSync(folder.file(name));
  for (const [file, set] of Object.entries(frames)) folder.write(join(name, file), encodePly(set));
  return folder.file(name);
}

/** The least x of each frame of a file. */
async function placesOf(path: string): Promise<number[]> {
  const { frames } = await openFrames(readFileSync(path));
  const sets = await Promise.all(frames.map((frame) => readSplats(frame)));
  return sets.map(({ positions, origin }) =>
    Math.min(...[0, 1, 2].map((i) => Math.round(10 * (positions[3 * i] + origin[0])))),
  );
}

const TEN = Object.fromEntries(Array.from({ length: 10 }, (_, i) => [`frame_${i + 1}.ply`, frameAt(i / 10)]));

describe('convert', () => {
  test('makes one file of a folder of frames, by the numbers in their names', async () => {
    const folder = new TestFolder();
    const frames = framesIn(folder, TEN);
    folder.write('frames/cameras.txt', 'no scene');
    const out = folder.file('out.frames');
    const { status, out: printed, err } = await runMain('convert', frames, out, '--fps', '20', '--json');
    expect(status, err).toBe(0);
    expect(JSON.parse(printed)).toMatchObject({
      ...{ format: 'frames', splats: 3, shDegree: 1, bytes: statSync(out).size },
      frames: { count: 10, keys: 1, perS: 20 },
      inputBytes: 10 * statSync(folder.file('frames/frame_1.ply')).size,
      notes: [],
    });
    expect(await placesOf(out)).toEqual([-10, -9, -8, -7, -6, -5, -4, -3, -2, -1]);
    const line = await runMain('convert', frames, out);
    expect(line.out).toMatch(
      /out\.frames: 10 frames of 3 splats, [\d,]+ bytes \(\d+\.\d % of what was read\), /,
    );
  });

  test('sorts frames with negative numbers, and hyphens before numbers', async () => {
    const folder = new TestFolder();
    const out = folder.file('out.frames');
    for (const [name, files] of Object.entries({
      bare: ['-2.ply', '-1.ply', '0.ply', '1.ply'],
      named: ['frame_-2.ply', 'frame_-1.ply', 'frame_0.ply', 'frame_1.ply'],
      joined: ['frame-2.ply', 'frame-1.ply', 'frame0.ply', 'frame1.ply'],
      hyphens: ['frame-1.ply', 'frame-2.ply', 'frame-9.ply', 'frame-10.ply'],
    })) {
      const frames = framesIn(
        folder,
        Object.fromEntries(files.map((file, i) => [file, frameAt(i + 2)])),
        name,
      );
      const { out: printed } = await runMain('convert', frames, out, '--json');
      expect(JSON.parse(printed).notes).toEqual([]);
      expect(await placesOf(out), name).toEqual([10, 20, 30, 40]);
    }
    const listed = ['-1.ply', '-2.ply'].map((file) => folder.file(`bare/${file}`));
    const { out: told } = await runMain('convert', ...listed, out, '--json');
    expect(JSON.parse(told).notes).toEqual([expect.stringMatching(/-2\.ply comes after .*-1\.ply, as/)]);
  });

  test('info tells frames, duration and bytes, and --time reads a frame', async () => {
    const folder = new TestFolder();
    const out = folder.file('out.frames');
    expect((await runMain('convert', framesIn(folder, TEN), out, '--fps', '20')).status).toBe(0);
    const bytes = statSync(out).size;
    const info = await runMain('info', out);
    const facts = `10, 0.5 s at 20 per second, ${bytes.toLocaleString('en')} bytes`;
    expect(info.out).toMatch(new RegExp(`^frames +${facts}$`, 'm'));
    const json = JSON.parse((await runMain('info', out, '--json')).out);
    const notes = [expect.stringContaining('Only the first of its 10 frames is shown')];
    expect(json.file).toEqual({ format: 'frames', frames: { count: 10, perS: 20, bytes }, notes });
    const back = folder.file('back.frames');
    for (const [time, least] of [
      ['0.12', -0.8],
      ['0.35', -0.3],
      ['7', -0.1],
      ['-1', -1],
    ] as const) {
      const ply = folder.file('at.ply');
      expect((await runMain('convert', out, ply, `--time=${time}`)).status).toBe(0);
      expect((await readSplats(readFileSync(ply))).count).toBe(3);
      const described = JSON.parse((await runMain('info', ply, '--json')).out);
      expect(described.bounds.min[0]).toBeCloseTo(least, 2);
    }
    // A file of frames is read frame by frame.
    expect((await runMain('convert', out, back, '--scale', '2')).status).toBe(0);
    expect(await placesOf(back)).toEqual([-20, -18, -16, -14, -12, -10, -8, -6, -4, -2]);
    const image = ['--camera', folder.camera(), '--size', '8x8', '--renderer', 'reference'];
    const pictures = ['0', '0.4'].map((time) => folder.file(`${time}.f32`));
    for (const [i, raw] of pictures.entries())
      expect((await runMain('render', out, ...image, '--raw', raw, `--time=${0.4 * i}`)).status).toBe(0);
    expect(readFileSync(pictures[0])).not.toEqual(readFileSync(pictures[1]));
  });

  test('several IN are frames in their order, with a note if that is not the order of their names', async () => {
    const folder = new TestFolder();
    framesIn(folder, TEN);
    const [one, two, ten] = [1, 2, 10].map((i) => folder.file(`frames/frame_${i}.ply`));
    const out = folder.file('out.frames');
    const sorted = await runMain('convert', one, two, ten, out);
    expect(sorted.err).not.toContain('comes after');
    expect(await placesOf(out)).toEqual([-10, -9, -1]);
    const { err } = await runMain('convert', one, ten, two, out);
    expect(err).toMatch(/^note: \S+frame_2\.ply comes after \S+frame_10\.ply, .* name the folder instead/m);
    expect(await placesOf(out)).toEqual([-10, -1, -9]);
  });

  test('frames of other rows, of other formats and single ones', async () => {
    const folder = new TestFolder();
    const lost = frameAt(0.1);
    lost.positions[0] = Number.NaN;
    const frames = framesIn(folder, { '0.ply': frameAt(0), '1.ply': lost, '2.ply': frameAt(0.2) });
    const out = folder.file('out.frames');
    const { out: printed } = await runMain('convert', frames, out, '--json');
    expect(JSON.parse(printed)).toMatchObject({
      frames: { count: 3, keys: 3 },
      notes: [expect.stringMatching(/^1 rows of \S+1\.ply are no splats/)],
    });
    mkdirSync(folder.file('spz'));
    for (const i of [0, 1]) {
      const bytes = await writeSplats(frameAt(i / 10), 'spz');
      writeFileSync(folder.file(`spz/${i}.spz`), bytes);
    }
    expect((await runMain('convert', folder.file('spz'), out)).status).toBe(0);
    expect(await placesOf(out)).toEqual([-10, -9]);
    expect((await runMain('convert', folder.scene(), out)).status).toBe(0);
    expect(await placesOf(out)).toEqual([-10]);
  });

  /**
   * @fault Command line: a folder of frames is empty, mixed or broken
   * @consequence one line, exit status 2, no file
   */
  test('bad frames give one line, status 2 and no file', async () => {
    const folder = new TestFolder();
    const out = folder.file('out.frames');
    mkdirSync(folder.file('empty'));
    const mixed = framesIn(folder, { '0.ply': frameAt(0) }, 'mixed');
    folder.write('mixed/0.spz', 'x');
    const broken = framesIn(folder, { '0.ply': frameAt(0) }, 'broken');
    folder.write('broken/1.ply', 'ply\n');
    const cut = folder.write('cut.frames', 'WSFRAMES');
    const cases: [string[], string][] = [
      [[folder.file('empty'), out], 'a folder without scenes; it must have a file for each frame'],
      [[mixed, out], 'scenes of several formats, ply, spz'],
      [[broken, out], '1.ply: '],
      [[folder.file('none'), out], 'there is no such file or folder'],
      [[cut, out], 'the header takes 32 bytes, the file has 8'],
      [[broken, out, '--fps', '0'], '--fps is 0; it must be 0.001 to 1000'],
      [[folder.scene(), folder.file('a.spz'), '--fps', '30'], '--fps is of frames, and OUT is'],
      [[broken, folder.file('broken/0.ply'), '--format', 'frames'], 'which is read too'],
    ];
    for (const [args, message] of cases) {
      const { status, out: printed, err } = await runMain('convert', ...args);
      expect([status, printed], message).toEqual([2, '']);
      expect(err).toContain(message);
      expect(err).toMatch(/^(\d+ %: [^\n]+\n)*websplatter: [^\n]+\n$/);
    }
    expect(() => statSync(out)).toThrow();
  });
});
