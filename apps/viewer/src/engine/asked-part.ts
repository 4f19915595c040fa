import type { PartLook, WaitingPart } from '../state/scene-part.ts';
import { type SceneSource, titleOf } from './scene-source.ts';
import type { ShownPart } from './shown-scene.ts';

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
}

/** Requests a file again with its current look. */
export function askedAgain({ key, source, look }: ShownPart): AskedPart {
  return { key, source, look };
}

export function waitingOf(queue: readonly AskedPart[]): WaitingPart[] {
  return queue.map(({ key, source }) => ({ key, title: titleOf(source) }));
}
