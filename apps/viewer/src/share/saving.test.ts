import { encodePly, readSplats } from '@websplatter/core';
import { gradeSplats, mergeSplats, WRITABLE_FORMATS } from '@websplatter/core/write';
import { builtinScenes } from '@websplatter/scenes';
import { afterEach, expect, test, vi } from 'vitest';
import { oneSplat } from '../engine/open/one-splat.fixture.ts';
import type { SceneSource } from '../engine/open/scene-source.ts';
import type { ShownPart } from '../engine/open/shown-scene.ts';
import type { Viewer } from '../engine/viewer.ts';
import { writeScene } from '../scene/write-scene.ts';
import { PLAIN_LOOK, type Placement } from '../state/scene-part.ts';
import { createViewerStore } from '../state/store.ts';
import { savedName } from './file-work.ts';
import { savingOf } from './saving.ts';

test.each([
  { formatName: 'spz', up: '-y', place: [1, 2, 3] },
  { formatName: 'spz', up: 'y', place: [1, -2, -3] },
  { formatName: 'spz', up: 'z', place: [1, -3, 2] },
  { formatName: 'gltf', up: '-y', place: [1, -2, -3] },
  { formatName: 'gltf', up: 'y', place: [1, 2, 3] },
  { formatName: 'gltf', up: 'z', place: [1, 3, -2] },
] as const)('$formatName of a scene with $up up has a splat at $place', async ({ formatName, up, place }) => {
  const source = { kind: 'file' as const, name: 'a.ply', source: new File([encodePly(oneSplat)], 'a.ply') };
  const phases = new Set<string>();
  const bytes = await writeScene(
    { parts: [{ source, placement: null, opacity: 1, rows: null }], formatName, up, crop: null },
    ({ phase }) => phases.add(phase),
  );
  const { positions, origin } = await readSplats(bytes);
  expect(origin.map((value, axis) => value + positions[axis])).toEqual(place);
  expect([...phases]).toEqual(['read', 'write']);
});

test('files of a scene are merged where they stand, as opaque as they are drawn', async () => {
  const file = new File([encodePly(oneSplat)], 'a.ply');
  const source = { kind: 'file' as const, name: 'a.ply', source: file };
  const placement: Placement = {
    ...{ move: [10, 0, 0], turnDegrees: [0, 0, 90], scale: 2, about: [1, 0, 0] },
    ...{ up: '-y', sceneUp: '-y' },
  };
  const parts = [
    { source, placement: null, opacity: 1, rows: null },
    { source, placement, opacity: 0.5, rows: null },
  ];
  const read: (number | undefined)[] = [];
  const bytes = await writeScene({ parts, formatName: 'ply', up: '-y', crop: null }, ({ phase, part }) => {
    if (phase === 'read') read.push(part);
  });
  const { count, positions, origin, opacityLogits } = await readSplats(bytes);
  expect(count).toBe(2);
  const places = Array.from(positions, (value, i) => value + origin[i % 3]);
  // The second: 0, 2, 3 from its middle, turned to −2, 0, 3, doubled, moved.
  expect(places).toEqual([1, 2, 3, 7, 0, 6]);
  expect(opacityLogits[0]).toBe(0);
  expect(opacityLogits[1]).toBeCloseTo(Math.log(0.25 / 0.75), 6);
  expect(read.at(-1)).toBe(1);
});

test('a grade is written into the colours', async () => {
  const source = { kind: 'file' as const, name: 'a.ply', source: new File([encodePly(oneSplat)], 'a.ply') };
  const parts = [{ source, placement: null, opacity: 1, rows: null }];
  const grade = { exposure: -1, saturation: 0 };
  const file = await writeScene({ parts, formatName: 'ply', up: 'y', crop: null, grade }, () => {});
  expect((await readSplats(file)).colorDc).toEqual(gradeSplats(oneSplat, grade).colorDc);
});

test('a crop is cut before it is turned', async () => {
  const source = { kind: 'file' as const, name: 'a.ply', source: new File([encodePly(oneSplat)], 'a.ply') };
  const crop = { min: [0, 1, 2], max: [2, 3, 4], keep: 'inside' } as const;
  const written = (keep: 'inside' | 'outside') =>
    writeScene(
      {
        parts: [{ source, placement: null, opacity: 1, rows: null }],
        formatName: 'ply',
        up: 'y',
        crop: { ...crop, keep },
      },
      () => {},
    );
  expect((await readSplats(await written('inside'))).count).toBe(1);
  await expect(written('outside')).rejects.toThrow('None of 1 splats');
});

test('of a file only the rows asked for are saved, bit for bit where nothing is turned', async () => {
  const rows = [0.1, -7e-8, 3e5].map((x) => ({ ...oneSplat, positions: Float32Array.of(x, 1 / 3, -x) }));
  const file = encodePly(mergeSplats(rows));
  const source = { kind: 'file' as const, name: 'a.ply', source: new File([file], 'a.ply') };
  const rowBytes = (bytes: Uint8Array) => {
    const end = new TextDecoder('latin1').decode(bytes).indexOf('end_header\n') + 'end_header\n'.length;
    return bytes.slice(end);
  };
  const written = (words: number[], areSaved: boolean) =>
    writeScene(
      {
        parts: [{ source, placement: null, opacity: 1, rows: { words: Uint32Array.from(words), areSaved } }],
        formatName: 'ply',
        up: '-y',
        crop: null,
      },
      () => {},
    );
  const whole = rowBytes(file);
  const size = whole.length / 3;
  expect(rowBytes(await written([0b10], true))).toEqual(whole.slice(size, 2 * size));
  expect(rowBytes(await written([0b1], false))).toEqual(whole.slice(size));
  expect(rowBytes(await written([], false))).toEqual(whole);
  await expect(written([], true)).rejects.toThrow('The scene has no splats left');
});

const opened = (name: string): SceneSource => ({ kind: 'file', name, source: new File([], name) });

test.each([
  [['garden.ply'], 'garden.spz'],
  [['garden.compressed.ply'], 'garden.spz'],
  [['garden.ply.gz'], 'garden.spz'],
  [['My garden, v1.5.SPZ'], 'My garden, v1.5.spz'],
  [['My garden.ply', 'House.spz'], 'My garden-and-House.spz'],
  [['a.ply', 'b.ply', 'c.ply', 'd.ply'], 'a-and-b-and-2 more.spz'],
  [['Straße 庭 .ply'], 'Straße 庭.spz'],
  [['a/b.ply'], 'a_b.spz'],
  [['.ply'], 'scene.spz'],
  [[], 'scene.spz'],
])('%s is saved as %s: people’s files keep their names', (names, name) => {
  expect(savedName(names.map(opened), { extension: '.spz' })).toBe(name);
});

test('a built-in scene is saved by the name of its address, not by its title', () => {
  const scene = builtinScenes.find(({ title }) => title === 'Still life, small')!;
  expect(savedName([{ kind: 'builtin', scene }], { extension: '.spz' })).toBe('still-life-small.spz');
});

class FakeWorker {
  static readonly started: FakeWorker[] = [];
  readonly posted: unknown[] = [];
  isEnded = false;
  onmessage: ((event: { data: object }) => void) | null = null;

  constructor() {
    FakeWorker.started.push(this);
  }

  postMessage(message: unknown): void {
    this.posted.push(message);
  }

  /** Replies to the one call, once it has come. */
  async reply(reply: object): Promise<void> {
    await expect.poll(() => this.posted).toHaveLength(1);
    this.onmessage?.({ data: { id: 1, ...reply } });
  }

  terminate(): void {
    this.isEnded = true;
  }
}

afterEach(() => vi.unstubAllGlobals());

const partOf = (source: SceneSource, look = PLAIN_LOOK): ShownPart => ({
  key: 1,
  source,
  contentKey: 'scene:garden',
  look,
  loaded: { clouds: [] } as unknown as ShownPart['loaded'],
});

function startSaving(source: SceneSource, look = PLAIN_LOOK) {
  vi.stubGlobal('Worker', FakeWorker);
  const store = createViewerStore();
  store.setState({ isFlipped: true });
  const viewer = { scenes: { newest: { parts: [partOf(source, look)] } } } as unknown as Viewer;
  const saving = savingOf(viewer, store);
  FakeWorker.started.length = 0;
  void saving.start(WRITABLE_FORMATS[0]);
  return { store, saving, worker: FakeWorker.started[0] };
}

test('progress is shown; saving can be cancelled, and started again', async () => {
  const { store, saving, worker } = startSaving({ kind: 'url', url: new URL('https://example.org/a.spz') });
  const source = { kind: 'url', href: 'https://example.org/a.spz' };
  await worker.reply({ kind: 'progress', progress: { phase: 'write', part: 0.5 } });
  const parts = [{ source, placement: null, opacity: 1, rows: null }];
  const input = { parts, formatName: WRITABLE_FORMATS[0].name, up: '-y', crop: null };
  expect(worker.posted).toEqual([{ task: 'save', id: 1, input }]);
  expect(store.getState().saving).toMatchObject({ phase: 'write', part: 0.5 });
  // One at a time.
  void saving.start(WRITABLE_FORMATS[0]);
  expect(FakeWorker.started.length).toBe(1);
  saving.cancel();
  await expect.poll(() => store.getState().saving).toBeNull();
  expect(worker.isEnded).toBe(true);
  expect(store.getState().notice).toContain('cancelled');
  void saving.start(WRITABLE_FORMATS[0]);
  expect(FakeWorker.started.length).toBe(2);
});

/**
 * @fault Files: a format rounds positions, sizes, colours or harmonics visibly: a stray in the same chunk,
 *   a tiny scene, bright colours
 */
test('what the format does not keep is told once the file is there', async () => {
  const logScales = new Float32Array(3).fill(-3);
  const far = { ...oneSplat, logScales, origin: [5e5 + 0.3, 5.3e6 + 0.3, 0.3] as const };
  const source = { kind: 'file' as const, name: 'a.ply', source: new File([encodePly(far)], 'a.ply') };
  const parts = [{ source, placement: null, opacity: 1, rows: null }];
  const notes: string[] = [];
  const request = { parts, formatName: 'sog', up: '-y', crop: null } as const;
  const bytes = await writeScene(
    request,
    () => {},
    (note) => notes.push(note),
  );
  expect(notes).toEqual([expect.stringContaining('in steps of 0.5')]);
  const { store, worker } = startSaving(source);
  vi.stubGlobal('document', { createElement: () => ({ click: () => {} }) });
  await worker.reply({ kind: 'done', result: { bytes, notes } });
  await expect.poll(() => store.getState().saving).toBeNull();
  expect(store.getState().notice).toMatch(
    /^Saved a\.\w+ \(.*\)\. Note: other readers of SOG .* PLY or glTF\.$/,
  );
});

/**
 * @fault Files: the viewer cannot save its scene
 * @consequence the reason is shown, and the scene stays
 */
test('a scene that cannot be saved is told with the reason, and stays', async () => {
  const { store, worker } = startSaving({ kind: 'file', name: 'a.ply', source: new File([], 'a.ply') });
  const error = { className: 'InvalidArgumentError', message: 'Splat 3 is far away.', argument: 'set' };
  await worker.reply({ kind: 'error', error });
  await expect.poll(() => store.getState().saving).toBeNull();
  expect(store.getState()).toMatchObject({
    failure: {
      ...{ message: 'Splat 3 is far away.', isFault: false },
      title: expect.stringContaining('cannot be saved'),
    },
  });
  expect(worker.isEnded).toBe(true);
});

test('neither hard cases nor hidden files are saved', () => {
  const file: SceneSource = { kind: 'file', name: 'a.ply', source: new File([], 'a.ply') };
  expect(startSaving(file, { ...PLAIN_LOOK, isHidden: true }).worker).toBeUndefined();
  expect(startSaving(file, { ...PLAIN_LOOK, opacity: 0 }).worker).toBeUndefined();
  const { store, worker } = startSaving({ kind: 'hard-case', name: 'sort-1-keys' });
  expect(worker).toBeUndefined();
  expect(store.getState().saving).toBeNull();
});
