import { type Harmonics, printable, type ShDegree, type SplatSet } from '@websplatter/core';
import {
  cropSplats,
  limitDegree,
  mergeSplats,
  transformSplats,
  WRITABLE_FORMATS,
  writeSplats,
} from '@websplatter/core/write';
import type { Console } from './console.ts';
import { type ConvertOptions, parseConvertArguments } from './convert-options.ts';
import { checkOutputs, reportBeside, writeFiles } from './output-files.ts';
import { tenthsOf } from './progress-lines.ts';
import { findScene, readScene, type SceneSource } from './scene-source.ts';

/** Output of `websplatter convert --json`. */
export interface Conversion {
  readonly scenes: readonly string[];
  readonly out: string;
  /** Name of the format, as in `SplatFormat`. */
  readonly format: string;
  readonly splats: number;
  readonly shDegree: ShDegree;
  readonly bytes: number;
  /** Bytes of all scenes together. */
  readonly inputBytes: number;
  readonly elapsedMs: number;
  /** What may surprise, a sentence each. */
  readonly notes: readonly string[];
}

/** A scene that was read. */
interface Input {
  readonly name: string;
  readonly isBuiltin: boolean;
  readonly set: SplatSet<Harmonics>;
  readonly bytes: number;
}

/** `websplatter convert IN… OUT`. */
export async function convert(args: readonly string[], console: Console): Promise<void> {
  const startMs = performance.now();
  const options = parseConvertArguments(args);
  const { out, format } = options;
  const output = { argument: 'OUT', path: out };
  const scenes = await Promise.all(options.scenes.map(findScene));
  const filesRead = () => scenes.flatMap(({ files }) => [...files]);
  await checkOutputs([output], filesRead());
  const report = await reportBeside([out], console);
  const showTenths = tenthsOf(console);
  const onRead = (index: number, fraction: number) =>
    showTenths({
      done: index + fraction,
      total: 2 * scenes.length,
      label: `reading ${printable(scenes[index].name)}`,
    });
  const inputs: Input[] = [];
  for (const [i, scene] of scenes.entries())
    inputs.push(await readInput(scene, (fraction) => onRead(i, fraction)));
  const set = edited(inputs, options);
  const onProgress = (fraction: number) =>
    showTenths({ done: 1 + fraction, total: 2, label: `writing ${printable(out)}` });
  const content = await writeSplats(set, format.name, { onProgress });
  await writeFiles([{ ...output, content }], filesRead());
  const conversion: Conversion = {
    scenes: options.scenes,
    out,
    format: format.name,
    splats: set.count,
    shDegree: set.harmonics.degree,
    bytes: content.length,
    inputBytes: inputs.reduce((sum, { bytes }) => sum + bytes, 0),
    elapsedMs: performance.now() - startMs,
    notes: notesOf(inputs, set, options),
  };
  for (const note of conversion.notes) console.err(`note: ${note}\n`);
  report(options.json ? `${JSON.stringify(conversion, null, 2)}\n` : line(conversion));
}

async function readInput(scene: SceneSource, onFraction: (fraction: number) => void): Promise<Input> {
  let bytes = 0;
  // A palette is written as it is where nothing changes it.
  const set = await readScene(scene, 'palette', ({ loadedBytes, totalBytes }) => {
    bytes = loadedBytes;
    if (totalBytes) onFraction(loadedBytes / totalBytes);
  });
  return { name: scene.name, isBuiltin: scene.isBuiltin, set, bytes };
}

/** Merged, moved, cropped and simplified, in this order. */
function edited(
  inputs: readonly Input[],
  { transform, crop, shDegree }: ConvertOptions,
): SplatSet<Harmonics> {
  const moved = transformSplats(mergeSplats(inputs.map(({ set }) => set)), transform);
  const cropped = crop ? cropSplats(moved, crop) : moved;
  return shDegree === undefined ? cropped : limitDegree(cropped, shDegree);
}

function notesOf(
  inputs: readonly Input[],
  { isAntialiased, fileFacts }: SplatSet<Harmonics>,
  { format, isTurnedUp }: ConvertOptions,
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
  if (!isTurnedUp && inputs.some(isTurned)) {
    const habit = 'axes are kept as they are; glTF has y up, and most files of other formats have y down';
    notes.push(`${habit}: --up -y turns the one into the other`);
  }
  return notes;
}

/** Whether files of a format have y up, whatever they show. */
function hasYUp(formatName: string): boolean {
  return WRITABLE_FORMATS.some((format) => format.name === formatName && format.hasYUp);
}

function line({ out, splats, bytes, inputBytes, elapsedMs }: Conversion): string {
  const ratio = ` (${((100 * bytes) / inputBytes).toFixed(1)} % of what was read)`;
  const seconds = (elapsedMs / 1000).toFixed(1);
  const counted = `${splats.toLocaleString('en')} splats, ${bytes.toLocaleString('en')} bytes`;
  return `${printable(out)}: ${counted}${ratio}, ${seconds} s\n`;
}
