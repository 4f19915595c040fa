import type { PartLook, WaitingPart } from '../state/scene-part.ts';
import { type SceneSource, titleOf } from './scene-source.ts';
import type { ShownPart } from './shown-scene.ts';

/** A file that was asked for, until it has been opened, has failed or was cancelled. */
export interface AskedPart {
  readonly key: number;
  readonly source: SceneSource;
  /** Null where it is found out when the file is there. */
  readonly look: PartLook | null;
  /** How a link writes its look. */
  readonly linkedLook?: string;
  /** Whether the address asks for it, so that its camera looks at it. */
  readonly isAddressed?: boolean;
}

/** A file that is opened again, as it was drawn. */
export function askedAgain({ key, source, look }: ShownPart): AskedPart {
  return { key, source, look };
}

export function waitingOf(queue: readonly AskedPart[]): WaitingPart[] {
  return queue.map(({ key, source }) => ({ key, title: titleOf(source) }));
}
