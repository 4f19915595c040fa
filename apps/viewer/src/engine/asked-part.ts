import type { HistoryState } from '../state/history.ts';
import type { CameraSnapshot } from '../state/saved-view.ts';
import type { PartLook, WaitingPart } from '../state/scene-part.ts';
import type { ViewerState } from '../state/store.ts';
import { type SceneSource, titleOf } from './scene-source.ts';
import type { ShownPart } from './shown-scene.ts';

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

export function waitingOf(queue: readonly AskedPart[]): WaitingPart[] {
  return queue.map(({ key, source }) => ({ key, title: titleOf(source) }));
}
