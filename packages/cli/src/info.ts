import {
  ACCURACY_PRESETS,
  type AccuracyPreset,
  type CloudFacts,
  cloudFacts,
  coefficientsPerSplat,
  type DropCounts,
  type FileFacts,
  GEOMETRY_WORDS,
  type Harmonics,
  motionBytesOf,
  printable,
  readCoefficients,
  type ShDegree,
  type SplatSet,
  shWordsPerSplat,
  type Vec3,
} from '@websplatter/core';
import { PieceFacts } from '@websplatter/core/write';
import type { Console } from './console.ts';
import { UsageError } from './input-error.ts';
import { flag, parseArguments, SHARED } from './options.ts';
import { checkOutputs } from './output-files.ts';
import { findScene, readScenePieces, type SceneSource } from './scene-source.ts';

/** A band of spherical harmonics above 0: its energy, and how much of it can be seen. */
interface ShBandInfo extends ShBand {
  /** Largest change to any splat's colour channel, in any direction; 1 is from black to white. */
  readonly reach: number;
}

/** Output of `websplatter info --json`. */
export interface SceneInfo {
  readonly scene: string;
  readonly count: number;
  /** Bounds of the splats' centres, in scene coordinates. */
  readonly bounds: { readonly min: Vec3; readonly max: Vec3 };
  /** Point that stored positions are relative to. */
  readonly origin: readonly [number, number, number];
  /** See `PieceFacts`. */
  readonly positionStep: number;
  readonly medianSize: number;
  /** First and last time of a moving scene; null if it stands still. */
  readonly timeRange: readonly [from: number, to: number] | null;
  /** Degree of the file. */
  readonly shDegree: ShDegree;
  /** Highest degree whose effect can be seen: bands up to it are stored on the GPU and drawn. */
  readonly trueShDegree: ShDegree;
  /** All bands of the file. */
  readonly shBands: readonly ShBandInfo[];
  /** Entries of the palette that the file's harmonics are; null if each splat has its own. */
  readonly paletteEntries: number | null;
  /** Number of splats in the file that were left out. */
  readonly droppedCount: number;
  readonly dropped: DropCounts;
  /** Facts from the file itself; null for generated scenes. */
  readonly file: FileFacts | null;
  /** Whether the file says that it was trained with an antialias filter; null if it is silent. */
  readonly isAntialiased: boolean | null;
  readonly gpuBytes: Readonly<Record<string, number>>;
}

/** `websplatter info SCENE [--json]`. */
export async function info(args: readonly string[], console: Console): Promise<void> {
  const { values, positionals } = parseArguments(args, { from: SHARED.from, json: flag }, (scenes) => {
    if (scenes.length !== 1) throw new UsageError('SCENE', `info needs one SCENE, found ${scenes.length}`);
  });
  const scene = await findScene(positionals[0], values.from);
  await checkOutputs([], scene.files);
  const found = await describeScene(scene);
  console.out(values.json ? `${JSON.stringify(found, null, 2)}\n` : table(found));
}

/** Holds no more of a scene than is read at once. */
async function describeScene(source: SceneSource): Promise<SceneInfo> {
  const facts = new PieceFacts();
  const energy = new ShEnergy();
  let last: CloudFacts | undefined;
  await readScenePieces(source, 'palette', async (piece) => {
    facts.add(piece);
    energy.add(piece);
    last = cloudFacts(piece);
  });
  const { declaredShDegree, trueShDegree, shBandReach, paletteEntries, fileFacts, isAntialiased } = last!;
  return {
    scene: source.name,
    count: facts.count,
    bounds: facts.bounds,
    origin: facts.origin,
    positionStep: facts.positionStep,
    medianSize: facts.medianSize,
    timeRange: facts.timeRange,
    shDegree: declaredShDegree,
    trueShDegree,
    shBands: energy.bands().map((band, i) => ({ ...band, reach: shBandReach[i] })),
    paletteEntries,
    droppedCount: Object.values(facts.dropped).reduce((sum, each) => sum + each, 0),
    dropped: facts.dropped,
    file: fileFacts,
    isAntialiased,
    gpuBytes: gpuBytesPerPreset(facts.count, trueShDegree, facts.timeRange !== null),
  };
}

function shDegreeText({ shDegree, trueShDegree }: SceneInfo): string {
  return trueShDegree === shDegree ? String(shDegree) : `${shDegree}, seen up to ${trueShDegree}`;
}

/** How fine positions are, beside the splats. */
function stepText({ positionStep, medianSize }: SceneInfo): string {
  const [step, size] = [positionStep, medianSize].map((value) => Number(value.toPrecision(2)));
  if (!(medianSize > 0)) return `${step}`;
  return `${step}, ${Number((positionStep / medianSize).toPrecision(2))} of the median size of splats, ${size}`;
}

function fileRows({ file, isAntialiased }: SceneInfo): [string, string][] {
  if (!file) return [];
  const { format, variant, writer, isSortedByDistance, notes = [], frames } = file;
  const named = variant ? `${format}, ${variant}` : format;
  return [
    ['format', printable(writer ? `${named}, written by ${writer}` : named)],
    ...(frames ? ([['frames', framesText(frames)]] as [string, string][]) : []),
    ...notes.map((note): [string, string] => ['note', printable(note)]),
    ...(isSortedByDistance ? ([['sorted by', 'distance from the camera']] as [string, string][]) : []),
    ...(isAntialiased === null
      ? []
      : ([['antialiased', isAntialiased ? 'yes, it was trained so' : 'no']] as [string, string][])),
  ];
}

function framesText({ count, perS, bytes }: NonNullable<FileFacts['frames']>): string {
  const seconds = Number((count / perS).toPrecision(3));
  const rate = Number(perS.toPrecision(4));
  return `${count.toLocaleString('en')}, ${seconds} s at ${rate} per second, ${bytes.toLocaleString('en')} bytes`;
}

function table(found: SceneInfo): string {
  const point = (values: readonly number[]) => values.map((value) => Number(value.toPrecision(7))).join('  ');
  const drops = Object.entries(found.dropped).map(([reason, count]) => `${count} ${reason}`);
  const rows: [string, string][] = [
    ['scene', printable(found.scene)],
    ...fileRows(found),
    ['splats', found.count.toLocaleString('en')],
    ['left out', drops.length === 0 ? 'none' : drops.join(', ')],
    ['bounds min', point(found.bounds.min)],
    ['bounds max', point(found.bounds.max)],
    ['origin', point(found.origin)],
    ['position step', stepText(found)],
    ...(found.timeRange ? ([['moves', `from ${found.timeRange.join(' to ')}`]] as [string, string][]) : []),
    ['SH degree', shDegreeText(found)],
    ...(found.paletteEntries
      ? ([['SH palette', `${found.paletteEntries.toLocaleString('en')} entries`]] as [string, string][])
      : []),
    ...found.shBands.map(({ band, rms, reach }): [string, string] => [
      `SH band ${band}`,
      `${rms.toPrecision(3)} rms, changes a colour by at most ${reach.toPrecision(3)}`,
    ]),
    ...Object.entries(found.gpuBytes).map(([preset, bytes]): [string, string] => [
      `GPU, ${preset}`,
      `${(bytes / 2 ** 20).toFixed(1)} MiB`,
    ]),
  ];
  const width = Math.max(...rows.map(([name]) => name.length));
  return rows.map(([name, value]) => `${name.padEnd(width)}  ${value}\n`).join('');
}

/** GPU bytes of `count` splats by accuracy preset, without a view's buffers for visible splats. */
function gpuBytesPerPreset(
  count: number,
  shDegree: ShDegree,
  isMoving: boolean,
): Record<AccuracyPreset, number> {
  const motionBytes = isMoving ? motionBytesOf(count) : 0;
  const bytes = Object.entries(ACCURACY_PRESETS).map(([preset, { geometryPrecision, shPrecision }]) => [
    preset,
    4 * count * (GEOMETRY_WORDS[geometryPrecision] + shWordsPerSplat(shDegree, shPrecision)) + motionBytes,
  ]);
  return Object.fromEntries(bytes);
}

interface ShBand {
  /** 1, 2 or 3. */
  readonly band: number;
  /** Root mean square of the band's coefficients over all splats and colour channels. */
  readonly rms: number;
}

/** Measures the energy of each band of spherical harmonics above 0, of splats in pieces. */
class ShEnergy {
  readonly #squares: number[] = [];
  #count = 0;

  add({ count, harmonics }: SplatSet<Harmonics>): void {
    const { degree } = harmonics;
    const values = new Float64Array(coefficientsPerSplat(degree));
    while (this.#squares.length < degree) this.#squares.push(0);
    for (let splat = 0; splat < count && degree > 0; splat++) {
      readCoefficients(harmonics, splat, values);
      for (let i = 0; i < degree; i++) {
        const [from, to] = bandRange((i + 1) as ShDegree);
        for (let value = from; value < to; value++) this.#squares[i] += values[value] ** 2;
      }
    }
    this.#count += count;
  }

  bands(): ShBand[] {
    return this.#squares.map((square, i) => {
      const band = (i + 1) as ShDegree;
      const [from, to] = bandRange(band);
      return { band, rms: this.#count === 0 ? 0 : Math.sqrt(square / (this.#count * (to - from))) };
    });
  }
}

/** Range of band `degree` among the 3K values of a splat. */
function bandRange(degree: ShDegree): [number, number] {
  return [coefficientsPerSplat((degree - 1) as ShDegree), coefficientsPerSplat(degree)];
}
