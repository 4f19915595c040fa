import { type Harmonics, InvalidArgumentError, type SplatSet } from '@websplatter/core';
import {
  type CropBox,
  cropSplats,
  filterSplats,
  type GradeOptions,
  gradeSplats,
  mergeSplats,
  splatsAt,
  transformSplats,
  uprightRotation,
  WRITABLE_FORMATS,
  writeSplats,
} from '@websplatter/core/write';
import type { LastingScene } from '../engine/open/lasting-scene.ts';
import { matrixOf, transformOf } from '../engine/open/placement.ts';
import { readAgain } from '../engine/open/read-again.ts';
import { type Crop, isKept } from '../state/inspecting.ts';
import type { SavingState } from '../state/saving.ts';
import type { Placement } from '../state/scene-part.ts';
import { oppositeAxis, type UpAxis } from '../state/up-axis.ts';

/** A set of a file's rows, which are either the only rows saved or left out. */
export interface SavedRows {
  /** Bit `row % 32` of word `row / 32` is set if the row is in the set. */
  readonly words: Uint32Array<ArrayBuffer>;
  readonly areSaved: boolean;
}

/** A file of a scene, and how it is drawn. */
export interface SavedPart {
  readonly source: LastingScene;
  /** Null if the file is placed as it was saved. */
  readonly placement: Placement | null;
  /** Above 0, at most 1. */
  readonly opacity: number;
  /** Which rows are saved; null: all. */
  readonly rows: SavedRows | null;
}

export interface SaveRequest {
  /** One or more; their splats are written one after another. */
  readonly parts: readonly SavedPart[];
  /** One of `WRITABLE_FORMATS`. */
  readonly formatName: string;
  /** The axis of the scene that is shown upwards. */
  readonly up: UpAxis;
  /** The part of the scene to save, in the scene's own space; null: all of it. */
  readonly crop: CropBox | null;
  /** Time at which a moving scene is frozen in formats that hold no motion. Default: 0. */
  readonly time?: number;
  /** Written into all colours; default: they stay. */
  readonly grade?: GradeOptions;
}

export type OnSaving = (progress: Pick<SavingState, 'phase' | 'part'>) => void;

/**
 * Reads a scene again and writes it as a file that other viewers show the same way up.
 *
 * @param onNote called with a sentence for each kind of data that the format cannot store.
 */
export async function writeScene(
  { parts, formatName, up, crop, time, grade }: SaveRequest,
  onProgress: OnSaving,
  onNote: (note: string) => void = () => {},
): Promise<Uint8Array<ArrayBuffer>> {
  onProgress({ phase: 'read', part: undefined });
  const sets: SplatSet<Harmonics>[] = [];
  for (const [i, { source, placement, opacity, rows }] of parts.entries()) {
    const whole = await readAgain(source, (part) => {
      onProgress({ phase: 'read', part: part === undefined ? undefined : (i + part) / parts.length });
    });
    noteFrame(source, whole, onNote);
    const set = rows ? savedSplats(whole, rows) : whole;
    if (set.count > 0)
      sets.push(fadedSplats(placement ? transformSplats(set, transformOf(placement)) : set, opacity));
  }
  if (sets.length === 0) throw new InvalidArgumentError('scene', 'The scene has no splats left to save.');
  const merged = mergeSplats(sets);
  onProgress({ phase: 'write', part: 0 });
  const format = WRITABLE_FORMATS.find(({ name }) => name === formatName);
  const held = merged.motion && !format?.hasMotion ? frozen(merged, time, formatName, onNote) : merged;
  const cropped = crop ? cropSplats(held, crop) : held;
  const set = grade ? gradeSplats(cropped, grade) : cropped;
  // In formats whose y axis points down, up is −y.
  const toY = format?.hasYUp ? up : oppositeAxis(up);
  const turned = toY === 'y' ? set : transformSplats(set, { rotation: uprightRotation(toY) });
  return writeSplats(turned, formatName, {
    onProgress: (part) => onProgress({ phase: 'write', part }),
    onNote,
  });
}

/** No format to write holds frames. */
function noteFrame(
  { frame }: LastingScene,
  { fileFacts }: SplatSet<Harmonics>,
  onNote: (note: string) => void,
): void {
  const count = fileFacts?.frames?.count;
  if (frame !== undefined && count) onNote(`Only the frame that is shown is saved, ${frame + 1} of ${count}`);
}

function frozen(
  set: SplatSet<Harmonics>,
  time = 0,
  formatName: string,
  onNote: (note: string) => void,
): SplatSet<Harmonics> {
  onNote(
    `The scene moves, which .${formatName} cannot hold: it is saved as it is at ${Number(time.toFixed(3))}.`,
  );
  return splatsAt(set, time);
}

/** A file of a scene with edits, to be written without what they hide. */
export interface CutRequest extends Omit<SavedPart, 'opacity'> {
  /** In the scene's own space; null: nothing is cropped. */
  readonly crop: Crop | null;
}

/** What edits leave of a file: nothing, all of it, or a new file. */
export type CutFile =
  | { readonly kind: 'nothing' | 'all' }
  | {
      readonly kind: 'file';
      readonly bytes: Uint8Array<ArrayBuffer>;
      readonly extension: string;
      /** A sentence for each kind of data that the format cannot store. */
      readonly notes: readonly string[];
    };

/**
 * A cut file becomes SOG, which rounds far less than SPZ at a similar size: SPZ coarsens harmonics
 * even of SPZ. Only glTF stays what it is: it has y up and is sorted by distance.
 */
const CUT_FORMAT = 'sog';
const KEPT_FORMAT = 'gltf';

/**
 * Reads a file again and writes what crop and removals leave of it, in its own place: it is still
 * drawn with the look of the whole file.
 */
export async function cutFile(
  { source, placement, rows, crop }: CutRequest,
  onProgress: OnSaving,
): Promise<CutFile> {
  const whole = await readAgain(source, (part) => onProgress({ phase: 'read', part }));
  const left = rows ? savedSplats(whole, rows) : whole;
  const set = crop ? croppedInPlace(left, placement, crop) : left;
  if (set.count === 0) return { kind: 'nothing' };
  if (set.count === whole.count) return { kind: 'all' };
  const kept = set.fileFacts?.format === KEPT_FORMAT ? KEPT_FORMAT : CUT_FORMAT;
  const { name: formatName, extension } = WRITABLE_FORMATS.find(({ name, hasMotion }) =>
    set.motion ? hasMotion : name === kept,
  )!;
  const notes: string[] = [];
  noteFrame(source, whole, (note) => notes.push(note));
  const bytes = await writeSplats(set, formatName, {
    onProgress: (part) => onProgress({ phase: 'write', part }),
    onNote: (note) => notes.push(note),
  });
  return { kind: 'file', bytes, extension, notes };
}

/** The splats whose centres the crop keeps where the file is placed, as the file has them. */
function croppedInPlace(
  set: SplatSet<Harmonics>,
  placement: Placement | null,
  crop: Crop,
): SplatSet<Harmonics> {
  const { positions, origin } = set;
  const m = placement && matrixOf(placement);
  return filterSplats(set, (i) => {
    const [x, y, z] = [0, 1, 2].map((axis) => positions[3 * i + axis] + origin[axis]);
    const along = (axis: number) =>
      m ? m[axis] * x + m[4 + axis] * y + m[8 + axis] * z + m[12 + axis] : [x, y, z][axis];
    return isKept(crop, [along(0), along(1), along(2)]);
  });
}

function savedSplats(set: SplatSet<Harmonics>, { words, areSaved }: SavedRows): SplatSet<Harmonics> {
  const { fileIndices } = set;
  // Rows beyond the last word read undefined, whose bits are 0.
  return filterSplats(
    set,
    (i) => (((words[fileIndices[i] >>> 5] >>> (fileIndices[i] & 31)) & 1) === 1) === areSaved,
  );
}

/** Multiplies every opacity by `by`. */
function fadedSplats(set: SplatSet<Harmonics>, by: number): SplatSet<Harmonics> {
  if (by === 1) return set;
  // The logit of by / (1 + e^−logit).
  const faded = (logit: number) => Math.log(by) - Math.log(1 - by + Math.exp(-logit));
  return { ...set, opacityLogits: set.opacityLogits.map(faded) };
}
