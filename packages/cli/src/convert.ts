import { availableParallelism, tmpdir } from 'node:os';
import { dirname } from 'node:path';
import {
  type Harmonics,
  type LoadProgress,
  printable,
  type SceneFraming,
  type ShDegree,
  type SplatSet,
  SplatSourceError,
  type Vec3,
} from '@websplatter/core';
import {
  AXIS_NAMES,
  canWritePieces,
  cropPiece,
  cropSplats,
  gradeSplats,
  limitDegree,
  mergeSplats,
  multiplyQuaternions,
  nothingLeft,
  openBrickWriter,
  openFrameWriter,
  PieceFacts,
  type Quaternion,
  SplatFramer,
  type SplatPieces,
  splatsAt,
  transformSplats,
  uprightRotation,
  WRITABLE_FORMATS,
  writeSplatPieces,
  writeSplats,
} from '@websplatter/core/write';
import { BrickThreads } from './brick-threads.ts';
import { directionName, SURE } from './choose-camera.ts';
import { type Console, tenthsOf } from './console.ts';
import { type ConvertOptions, FRAMES, parseConvertArguments } from './convert-options.ts';
import { frameScenes, orderNote } from './frame-scenes.ts';
import { UsageError } from './input-error.ts';
import { AUTO } from './options.ts';
import {
  checkOutputs,
  noteLeftOutputs,
  type OutputFile,
  type PutContent,
  putContent,
  reportBeside,
  writeFiles,
} from './output-files.ts';
import { outputPlace, STDIO } from './output-place.ts';
import { findScene, readScene, readScenePieces, type SceneSource } from './scene-source.ts';
import { TemporaryFolder } from './temporary-folder.ts';

/** Output of `websplatter convert --json`. */
export interface Conversion {
  readonly scenes: readonly string[];
  readonly out: string;
  /** Name of the format, as in `SplatFormat`. */
  readonly format: string;
  readonly splats: number;
  readonly shDegree: ShDegree;
  /** Frames of a file of frames, of which `splats` are in the largest. */
  readonly frames?: FrameCounts;
  readonly bytes: number;
  /** Bytes of all scenes together. */
  readonly inputBytes: number;
  readonly elapsedMs: number;
  /** Up as `--up auto` found it, in the axes of the scenes. */
  readonly foundUp?: FoundUp;
  /** Surprising facts, a sentence each. */
  readonly notes: readonly string[];
}

/** Frames of a file, key frames among them, and frames per second. */
interface FrameCounts {
  readonly count: number;
  readonly keys: number;
  readonly perS: number;
}

/** A scene that was read, or facts about one that is read in pieces. */
interface Input {
  readonly name: string;
  readonly isBuiltin: boolean;
  readonly set: Pick<SplatSet<Harmonics>, 'dropped' | 'isAntialiased' | 'fileFacts'>;
  readonly bytes: number;
}

/** The output to write. */
interface Result {
  readonly inputs: readonly Input[];
  readonly upright: Upright;
  readonly set: Pick<SplatSet<Harmonics>, 'count' | 'isAntialiased' | 'fileFacts'>;
  readonly shDegree: ShDegree;
  readonly frames?: FrameCounts;
  readonly content: OutputFile['content'];
  /** Sentences on the data that the format cannot keep; complete once the content is written. */
  readonly losses: () => readonly string[];
  /** To be called once the content is written, or cannot be. */
  end?(): Promise<void>;
}

/** Told the fraction, 0 to 1, that is done of reading scene `index`, or of writing without one. */
type OnFraction = (fraction: number, index?: number) => void;

/** A moving splat has many places. */
const CROPPED_MOVING =
  'splats that move were cropped by their places at their own times (trbf_center); --time freezes a scene before it is cropped';

/** Larger files are not held in memory, but read several times where source and format allow it. */
const HELD_BYTES = 1 << 28;
/** Threads that make bricks at once: each takes about 140 MB, and all together less than 2 GB. */
const MOST_THREADS = 12;

/** Scenes that are larger, or of unknown size, are divided into bricks by workers, on the disk. */
const HELD_BRICKS_BYTES = 1 << 24;

/** `websplatter convert IN… OUT`. */
export async function convert(args: readonly string[], console: Console): Promise<void> {
  const startMs = performance.now();
  const options = parseConvertArguments(args);
  const { out, format } = options;
  const output = { argument: 'OUT', path: out };
  const scenes =
    format === FRAMES
      ? await frameScenes(options.scenes, options.from)
      : await Promise.all(options.scenes.map((scene) => findScene(scene, options.from, options.time)));
  const filesRead = () => scenes.flatMap(({ files }) => [...files]);
  await checkOutputs([output], filesRead());
  await noteLeftOutputs([output], console);
  const report = await reportBeside([out], console);
  const showTenths = tenthsOf(console);
  const onFraction: OnFraction = (fraction, index) =>
    index === undefined
      ? showTenths({ done: 1 + fraction, total: 2, label: `writing ${printable(out)}` })
      : showTenths({
          done: index + fraction,
          total: 2 * scenes.length,
          label: `reading ${printable(scenes[index].name)}`,
        });
  const result = await wayOf(scenes, options)(scenes, options, onFraction);
  const { inputs, set, shDegree, frames, content, end, upright } = result;
  let bytes = 0;
  const counted: PutContent = (put) =>
    putContent(content, (part) => {
      bytes += part.length;
      return put(part);
    });
  try {
    await writeFiles([{ ...output, content: counted }], filesRead());
  } finally {
    await end?.();
  }
  const conversion: Conversion = {
    scenes: options.scenes,
    out,
    format: format.name,
    splats: set.count,
    shDegree,
    ...(frames && { frames }),
    bytes,
    inputBytes: inputs.reduce((sum, input) => sum + input.bytes, 0),
    elapsedMs: performance.now() - startMs,
    ...(upright.found && { foundUp: upright.found }),
    notes: [...upright.notes, ...notesOf(inputs, set, options), ...result.losses()],
  };
  for (const note of conversion.notes) console.err(`note: ${note}\n`);
  report(options.json ? `${JSON.stringify(conversion, null, 2)}\n` : line(conversion));
}

async function whole(
  scenes: readonly SceneSource[],
  options: ConvertOptions,
  onFraction: OnFraction,
): Promise<Result> {
  const inputs: (Input & { readonly set: SplatSet<Harmonics> })[] = [];
  for (const [i, scene] of scenes.entries()) {
    let bytes = 0;
    // A palette is written as it is where nothing changes it.
    const set = await readScene(scene, 'palette', ({ loadedBytes, totalBytes }) => {
      bytes = loadedBytes;
      if (totalBytes) onFraction(loadedBytes / totalBytes, i);
    });
    inputs.push({ name: scene.name, isBuiltin: scene.isBuiltin, set, bytes });
  }
  const upright = await uprightOf(options, async (framer) => {
    for (const input of inputs) framer.add(input.set);
  });
  const set = edited(mergeSplats(inputs.map((input) => input.set)), options, upright, cropSplats);
  const losses = mergeLosses(inputs.map((input) => input.set));
  if (options.crop && set.motion) losses.push(CROPPED_MOVING);
  const onNote = (note: string) => losses.push(note);
  const content = await writeSplats(set, options.format.name, { onProgress: onFraction, onNote });
  return { inputs, upright, set, shDegree: set.harmonics.degree, content, losses: () => losses };
}

/** A step is too coarse if it is longer than this part of the median size of splats. */
const MOST_STEP = 1 / 2;

/** Notes on float32 precision lost by merging scenes that lie far apart about one origin. */
function mergeLosses(sets: readonly SplatSet<Harmonics>[]): string[] {
  const factsOf = (parts: readonly SplatSet<Harmonics>[]) => {
    const facts = new PieceFacts();
    for (const part of parts) facts.add(part);
    return facts;
  };
  const { positionStep, medianSize } = factsOf(sets);
  const harmless = sets.reduce(
    (most, set) => Math.max(most, factsOf([set]).positionStep),
    MOST_STEP * medianSize,
  );
  if (positionStep <= harmless) return [];
  const [step, size] = [positionStep, medianSize].map((value) => Number(value.toPrecision(2)));
  return [
    `the scenes lie too far apart for float32: together, splats are placed in steps of ${step}, and their median size is ${size}. Keep them in files of their own`,
  ];
}

/** How scenes are converted: as a whole, or in pieces where they may be too large to be held. */
function wayOf(scenes: readonly SceneSource[], { format }: ConvertOptions) {
  const sizes = scenes.map(({ source }) =>
    source instanceof Object && 'size' in source ? Number(source.size) : Number.POSITIVE_INFINITY,
  );
  const bytes = sizes.reduce((sum, size) => sum + size, 0);
  if (format === FRAMES) return inFrames;
  if (format.name === 'bricks') return bytes > HELD_BRICKS_BYTES ? inBuckets : whole;
  // Others read a scene several times.
  const isLarge = bytes > HELD_BYTES && Number.isFinite(bytes);
  return scenes.length === 1 && isLarge && canWritePieces(format.name) ? inPieces : whole;
}

/** Reads all scenes once, and divides them into bricks on the disk. */
async function inBuckets(
  scenes: readonly SceneSource[],
  options: ConvertOptions,
  onFraction: OnFraction,
): Promise<Result> {
  const upright = await uprightOfPieces(scenes, options);
  const threadCount = Math.min(availableParallelism(), MOST_THREADS);
  const threads = new BrickThreads(threadCount);
  const folder = new TemporaryFolder(options.temp ?? (await folderOf(options.out)));
  const { makeFile } = folder;
  const writer = await openBrickWriter({ makeFile, run: threads.run, threads: threadCount });
  const end = async () => {
    await writer.end();
    await threads.end();
  };
  try {
    const inputs: (Input & { readonly set: PieceFacts })[] = [];
    let [splats, isRoomChecked] = [0, false];
    for (const [i, scene] of scenes.entries()) {
      const facts = new PieceFacts();
      let bytes = 0;
      let progress: LoadProgress | undefined;
      const onPiece = async (piece: SplatSet<Harmonics>) => {
        const changed = edited(piece, options, upright, cropPiece);
        facts.add(changed);
        await writer.add(changed);
        if (isRoomChecked || !progress?.totalBytes) return;
        isRoomChecked = true;
        const expected = (facts.count * progress.totalBytes) / progress.loadedBytes;
        await folder.checkRoom(writer.temporaryBytes(expected, facts.shDegree));
      };
      await readScenePieces(scene, 'palette', onPiece, (now) => {
        progress = now;
        bytes = now.loadedBytes;
        if (now.totalBytes) onFraction(now.loadedBytes / now.totalBytes, i);
      });
      splats += progress?.splats ?? 0;
      inputs.push({ name: scene.name, isBuiltin: scene.isBuiltin, set: facts, bytes });
    }
    if (writer.count === 0 && options.crop) throw nothingLeft(splats, options.crop);
    const sets = inputs.map(({ set }) => set);
    const shDegree = sets.reduce<ShDegree>((most, set) => (set.shDegree > most ? set.shDegree : most), 0);
    const content: PutContent = (put) => writer.finish(put, onFraction);
    return {
      inputs,
      upright,
      set: { count: writer.count, isAntialiased: writer.isAntialiased, fileFacts: undefined },
      shDegree,
      content,
      losses: () => writer.notes,
      end,
    };
  } catch (error) {
    await end();
    throw error;
  }
}

/** Where a file lies, and its temporary data, too. */
async function folderOf(out: string): Promise<string> {
  const { kind, path } = await outputPlace(out);
  return kind === 'file' ? dirname(path) : tmpdir();
}

/** Reads frame by frame; they are held compressed. */
async function inFrames(
  scenes: readonly SceneSource[],
  options: ConvertOptions,
  onFraction: OnFraction,
): Promise<Result> {
  const upright = await uprightOfPieces(scenes.slice(0, 1), options);
  const writer = await openFrameWriter({ framesPerS: options.framesPerS });
  const inputs: Input[] = [];
  let [most, shDegree]: [number, ShDegree] = [0, 0];
  let set: Result['set'] = { count: 0, isAntialiased: undefined, fileFacts: undefined };
  for (const [i, scene] of scenes.entries()) {
    let bytes = 0;
    const read = await readScene(scene, 'f32', (progress) => {
      bytes = progress.loadedBytes;
    });
    const frame = edited(read, options, upright, cropSplats);
    await writer.add(frame);
    const { dropped, isAntialiased, fileFacts } = read;
    inputs.push({ ...scene, set: { dropped, isAntialiased, fileFacts }, bytes });
    if (frame.count > most) most = frame.count;
    if (frame.harmonics.degree > shDegree) shDegree = frame.harmonics.degree;
    set = { count: most, isAntialiased: writer.isAntialiased, fileFacts };
    onFraction(1, i);
  }
  const { frameCount, keyCount, framesPerS } = writer;
  const note = orderNote(options.scenes);
  return {
    ...{ inputs, upright, set, shDegree, losses: () => (note === undefined ? [] : [note]) },
    frames: { count: frameCount, keys: keyCount, perS: framesPerS },
    content: (put) => writer.finish(put),
  };
}

/** Reads the scene once for the facts that the output begins with, and again for each part. */
async function inPieces(
  [scene]: readonly SceneSource[],
  options: ConvertOptions,
  onFraction: OnFraction,
): Promise<Result> {
  const upright = await uprightOfPieces([scene], options);
  const facts = new PieceFacts();
  let bytes = 0;
  const read = (
    onPiece: (piece: SplatSet<Harmonics>) => Promise<void>,
    onProgress?: (progress: LoadProgress) => void,
  ) =>
    readScenePieces(
      scene,
      'palette',
      (piece) => onPiece(edited(piece, options, upright, cropPiece)),
      onProgress,
    );
  let splats = 0;
  await read(
    async (piece) => facts.add(piece),
    (progress) => {
      bytes = progress.loadedBytes;
      splats = progress.splats;
      if (progress.totalBytes) onFraction(progress.loadedBytes / progress.totalBytes, 0);
    },
  );
  if (facts.count === 0 && options.crop) throw nothingLeft(splats, options.crop);
  const readAgain: SplatPieces['read'] = async (onPiece) => {
    const now = new PieceFacts();
    await read(async (piece) => {
      now.add(piece);
      await onPiece(piece);
    });
    if (now.count !== facts.count)
      throw new SplatSourceError(scene.name, 'it changed while it was read; convert it again');
  };
  const losses = options.crop && facts.timeRange ? [CROPPED_MOVING] : [];
  const onNote = (note: string) => losses.push(note);
  const writing = { onProgress: onFraction, onNote };
  const content: PutContent = (put) =>
    writeSplatPieces({ facts, read: readAgain }, options.format.name, writing, put);
  const { name, isBuiltin } = scene;
  return {
    inputs: [{ name, isBuiltin, set: facts, bytes }],
    ...{ upright, set: facts, shDegree: facts.shDegree, content, losses: () => losses },
  };
}

/** How the scenes become upright, by what `add` adds where it is to be found. */
async function uprightOf(
  { up }: ConvertOptions,
  add: (framer: SplatFramer) => Promise<void>,
): Promise<Upright> {
  if (up === AUTO) return findUpright(add);
  return { rotation: uprightRotation(up ?? 'y'), found: null, notes: [] };
}

/** The same of scenes that are read in pieces: once more, where up is to be found. */
async function uprightOfPieces(scenes: readonly SceneSource[], options: ConvertOptions): Promise<Upright> {
  return uprightOf(options, async (framer) => {
    if (scenes.some(({ files }) => files.has(STDIO))) {
      const message =
        '--up auto reads a scene of any size twice, and standard input can be read once; name the axis: --up=-y';
      throw new UsageError('--up', message);
    }
    for (const scene of scenes) await readScenePieces(scene, 'palette', async (piece) => framer.add(piece));
  });
}

/** Frozen, turned upright, moved, cropped, simplified and graded, in this order. */
function edited(
  set: SplatSet<Harmonics>,
  { time, transform, crop, shDegree, grade }: ConvertOptions,
  upright: Upright,
  cropBy: typeof cropSplats,
): SplatSet<Harmonics> {
  const rotation = multiplyQuaternions(transform.rotation!, upright.rotation);
  const frozen = time === undefined ? set : splatsAt(set, time);
  const moved = transformSplats(frozen, { ...transform, rotation });
  const cropped = crop ? cropBy(moved, crop) : moved;
  return gradeSplats(shDegree === undefined ? cropped : limitDegree(cropped, shDegree), grade);
}

function notesOf(
  inputs: readonly Input[],
  { isAntialiased, fileFacts }: Result['set'],
  { format, up }: ConvertOptions,
): string[] {
  const notes: string[] = [];
  for (const { name, set } of inputs) {
    const dropped = Object.values(set.dropped).reduce((sum, count) => sum + count, 0);
    if (dropped > 0) notes.push(`${dropped} rows of ${printable(name)} are no splats and were left out`);
    for (const note of set.fileFacts?.notes ?? []) notes.push(`${printable(name)}: ${printable(note)}`);
  }
  if (inputs.some(({ set }) => set.isAntialiased) && !(format.tellsAntialiased && isAntialiased))
    notes.push('nothing in the new file says that splats were trained with an antialias filter');
  const keepsDistances = format.name === 'gltf' && fileFacts?.isSortedByDistance;
  if (inputs.some(({ set }) => set.fileFacts?.isSortedByDistance) && !keepsDistances)
    notes.push('nothing in the new file says that splats are sorted by their distances from the camera');
  const isTurned = ({ set, isBuiltin }: Input) =>
    set.fileFacts !== undefined && (isBuiltin || hasYUp(set.fileFacts.format)) !== format.hasYUp;
  if (up === undefined && inputs.some(isTurned)) {
    const habit = 'axes are kept as they are; glTF has y up, and most files of other formats have y down';
    notes.push(`${habit}: --up=-y turns the one into the other, and --up auto finds what is up`);
  }
  return notes;
}

/** Whether the format's coordinate system has y up. */
function hasYUp(formatName: string): boolean {
  return WRITABLE_FORMATS.some((format) => format.name === formatName && format.hasYUp);
}

function line({ out, splats, frames, bytes, inputBytes, elapsedMs }: Conversion): string {
  const ratio = inputBytes > 0 ? ` (${((100 * bytes) / inputBytes).toFixed(1)} % of what was read)` : '';
  const seconds = (elapsedMs / 1000).toFixed(1);
  const times = frames ? `${frames.count} frames of ` : '';
  const counted = `${times}${splats.toLocaleString('en')} splats, ${bytes.toLocaleString('en')} bytes`;
  return `${printable(out)}: ${counted}${ratio}, ${seconds} s\n`;
}

/** Up as `convert --up auto` found it. */
interface FoundUp {
  /** Unit vector in the axes of the scenes. */
  readonly direction: Vec3;
  /** 0…1. */
  readonly confidence: number;
}

/** The rotation that makes scenes upright, and the line that says how it was found. */
interface Upright {
  readonly rotation: Quaternion;
  /** Null if nothing was looked for, or no splat can be seen. */
  readonly found: FoundUp | null;
  readonly notes: readonly string[];
}

/** Finds up in what `add` adds, and the rotation that turns it to +y. */
async function findUpright(add: (framer: SplatFramer) => Promise<void>): Promise<Upright> {
  const framer = new SplatFramer();
  await add(framer);
  const framing = framer.frame();
  if (!framing) {
    const note = 'no splat can be seen that would tell which way is up; nothing was turned upright';
    return { rotation: uprightRotation('y'), found: null, notes: [note] };
  }
  const { up, confidence } = framing;
  return {
    rotation: rotationToY(up),
    found: { direction: up, confidence: confidence.up },
    notes: [noteOf(framing)],
  };
}

/** Shortest rotation from `up` to +y. A direction that points down is rotated as if from −y first. */
function rotationToY(up: Vec3): Quaternion {
  const name = directionName(up);
  if (AXIS_NAMES.includes(name)) return uprightRotation(name);
  const half = uprightRotation(up[1] < 0 ? '-y' : 'y');
  const [x, y, z] = up[1] < 0 ? [up[0], -up[1], -up[2]] : up;
  return multiplyQuaternions([1 + y, -z, 0, x], half);
}

function noteOf({ up, confidence }: SceneFraming): string {
  const sureness = `confidence ${confidence.up.toFixed(2)} of 1`;
  if (confidence.up >= SURE) return `${directionName(up)} was found to be up (${sureness})`;
  return `it is uncertain which way is up: ${directionName(up)} was taken (${sureness}); --up with x, y, z, -x, -y or -z decides it`;
}
