import type { HistoryState } from '../../state/history.ts';
import type { FailureReport } from '../../state/messages.ts';
import type { CameraSnapshot } from '../../state/saved-view.ts';
import type { PartLook } from '../../state/scene-part.ts';
import type { ViewerState } from '../../state/store.ts';
import type { Session } from '../show/session.ts';
import type { SceneSource } from './scene-source.ts';
import type { ShownPart, ShownScene } from './shown-scene.ts';

/** Effects, inspection and edits of a scene. */
export type SceneWork = Pick<ViewerState, 'requested' | 'inspecting' | keyof HistoryState>;

export function workOn({ requested, inspecting, past, undone, gesture }: ViewerState): SceneWork {
  return { requested, inspecting, past, undone, gesture };
}

/** A scene that another one has replaced, with all that a person had made of it. */
export interface ReplacedWork {
  readonly parts: readonly ShownPart[];
  readonly camera: CameraSnapshot;
  readonly work: SceneWork;
}

/** A file to open, until it has opened, failed or been cancelled. */
export interface AskedPart {
  readonly key: number;
  readonly source: SceneSource;
  /** How the file is drawn; null: decided once it has loaded. */
  readonly look: PartLook | null;
  /** The look as written in the page's URL. */
  readonly linkedLook?: string;
  /** Whether the page's URL names the file; if so, the URL's camera applies. */
  readonly isAddressed?: boolean;
  /** The scene that is brought back with this file, the last of its files. */
  readonly left?: ReplacedWork;
}

/** Requests a file again with its current look. */
export function askedAgain({ key, source, look }: Pick<ShownPart, 'key' | 'source' | 'look'>): AskedPart {
  return { key, source, look };
}

/** The loaded part of a file in progress, drawn with the files that it joins. */
export interface Preview {
  readonly scene: ShownScene;
  readonly part: ShownPart;
  /** The camera before the preview; null if there was no scene. */
  readonly camera: CameraSnapshot | null;
  /** Effects and edits before the preview. */
  readonly work: SceneWork;
}

/** A preview that is not drawn yet because its first view is being found. */
export interface WaitingPreview extends Pick<Preview, 'scene' | 'part'> {
  readonly asked: AskedPart;
  /** Aborts the framing; all previews of a load share it. */
  readonly framing: AbortController;
}

/**
 * What is open and what is being opened. A value is never changed: each function below returns the value
 * after an event. Only another look, or a removed file, exchanges `scene` or `queue` alone.
 */
export interface SceneLoad {
  /** The scene opened last, with its completely loaded files; its session may have ended. */
  readonly scene: ShownScene | null;
  /** Files to open; the first is being read. A file leaves once opened, failed or cancelled. */
  readonly queue: readonly AskedPart[];
  /** Aborts reading of the first file; null while none is read. */
  readonly reading: AbortController | null;
  /**
   * What the next file does that opens.
   * - `replaces`: it takes the place of the scene.
   * - `begins`: it belongs to a new scene, whose first view was found from all files that are open.
   * - `completes`: it belongs to a new scene, whose first view was found from a part of it. The view is found
   *   again once all files are open.
   * - `joins`: it stands beside others; the view stays.
   */
  readonly role: 'replaces' | 'begins' | 'completes' | 'joins';
  /** Files of the queue that could not be opened. */
  readonly failures: readonly FailureReport[];
  readonly stage: LoadStage;
}

/**
 * - `idle`: no file is read; without a session, the queue waits for one.
 * - `opening`: a file is read, and nothing of it is drawn.
 * - `framing`: a first view is being found, of the loaded part of a file that is still read, or again of the
 *   scene that is drawn.
 * - `arriving`: the loaded part of a file is drawn.
 * - `shown`: all files are open.
 * - `failed`: none of them could be opened, and no scene of this session is there.
 */
export type LoadStage =
  | { readonly at: 'idle' | 'opening' | 'shown' | 'failed' }
  | { readonly at: 'framing'; readonly of: WaitingPreview | 'scene' }
  | { readonly at: 'arriving'; readonly preview: Preview };

const IDLE: LoadStage = { at: 'idle' };
const OPENING: LoadStage = { at: 'opening' };

export const NOTHING_ASKED: SceneLoad = {
  scene: null,
  queue: [],
  reading: null,
  role: 'replaces',
  failures: [],
  stage: IDLE,
};

/** A person opens files beside others. */
export function added(load: SceneLoad, files: readonly AskedPart[]): SceneLoad {
  return { ...load, queue: [...load.queue, ...files], failures: [] };
}

/** A person opens files in place of all others. */
export function replaced(load: SceneLoad, queue: readonly AskedPart[]): SceneLoad {
  return { ...NOTHING_ASKED, scene: load.scene, queue };
}

/** Files are to be opened before others that wait, in place of the scene and without a person's wish. */
export function putFirst(load: SceneLoad, files: readonly AskedPart[]): SceneLoad {
  return { ...load, queue: [...files, ...load.queue], role: 'replaces' };
}

/** Reading of the first file of the queue begins. */
export function began(load: SceneLoad, reading: AbortController): SceneLoad {
  return { ...load, reading, stage: OPENING };
}

/** A part of a new scene has loaded, and its first view is being found. */
export function waits(load: SceneLoad, of: WaitingPreview): SceneLoad {
  return { ...load, stage: { at: 'framing', of } };
}

/** A part of the file is drawn. */
export function arrived(load: SceneLoad, preview: Preview): SceneLoad {
  return { ...load, stage: { at: 'arriving', preview } };
}

/** Parts of the file are not drawn any more: it failed, was cancelled, or all of it has loaded. */
export function dropped(load: SceneLoad): SceneLoad {
  return { ...load, stage: OPENING };
}

/**
 * All of the file is part of `scene`.
 *
 * @param isReopened whether the file was so before the device was lost, or is brought back.
 */
export function opened(load: SceneLoad, scene: ShownScene, isReopened: boolean): SceneLoad {
  const { role, stage } = load;
  const { parts, firstView, ownCameras } = scene;
  const isAlone = parts.length === 1;
  const isFramedInPart = !firstView && !ownCameras && (!isAlone || stage.at === 'arriving');
  const isBeginning = !isReopened && (isAlone || role !== 'joins');
  const beginning = isFramedInPart || role === 'completes' ? 'completes' : 'begins';
  return { ...load, scene, role: isBeginning ? beginning : 'joins', stage: OPENING };
}

export function failed(load: SceneLoad, report: FailureReport): SceneLoad {
  return { ...load, failures: [...load.failures, report] };
}

/** The last file of the queue is open or has failed. */
export function completed(load: SceneLoad): SceneLoad {
  const { role, stage } = load;
  return {
    ...load,
    role: role === 'replaces' ? role : 'joins',
    stage: role === 'completes' ? { at: 'framing', of: 'scene' } : stage,
  };
}

/** The first file leaves the queue. */
export function ended(load: SceneLoad, session: Session | null): SceneLoad {
  const { scene } = load;
  const queue = load.queue.slice(1);
  if (queue.length > 0) return { ...load, queue, reading: null, stage: IDLE };
  const stage: LoadStage = { at: scene && scene.session === session ? 'shown' : 'failed' };
  return { ...NOTHING_ASKED, scene, role: 'joins', stage };
}

/** The GPU is lost, or other files are about to be opened. */
export function stopped(load: SceneLoad): SceneLoad {
  return { ...load, reading: null, role: load.role === 'replaces' ? 'replaces' : 'joins', stage: IDLE };
}

/** The preview that is drawn, if there is one. */
export function previewOf({ stage }: SceneLoad): Preview | null {
  return stage.at === 'arriving' ? stage.preview : null;
}

/** The preview that waits for its first view, if there is one. */
export function waitingOf({ stage }: SceneLoad): WaitingPreview | null {
  return stage.at === 'framing' && stage.of !== 'scene' ? stage.of : null;
}

/** Whether the scene on the screen is incomplete, or its first view is found again from all its files. */
export function isPartial({ stage }: SceneLoad): boolean {
  return stage.at === 'arriving' || (stage.at === 'framing' && stage.of === 'scene');
}
