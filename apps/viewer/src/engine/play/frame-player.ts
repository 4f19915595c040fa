import { DestroyedError, type LoadProgress, type SplatCloud } from '@websplatter/core';
import type { SplatFrames } from '@websplatter/core/frames';
import { reportFailure } from '../open/failure-report.ts';
import { lastingScene } from '../open/lasting-scene.ts';
import { titleOf } from '../open/scene-source.ts';
import type { ShownPart } from '../open/shown-scene.ts';
import type { Session } from '../show/session.ts';
import type { PanelProps } from '../viewer.ts';
import { frameAt, openFrameFile } from './open-frame-file.ts';
import { framesOf } from './scene-time.ts';

/** Most frames that are kept on the GPU from the scene's time on. */
const HELD_FRAMES = 4;
/** One frame is fetched while the one before is decoded. */
const LOADS_AT_ONCE = 2;

/**
 * Shows the frames of the scene's files of frames at the scene's time. Returns a function that stops this; the
 * frames on the screen stay.
 */
export function playFrames({ store, viewer }: PanelProps): () => void {
  const players = new Map<number, FramePlayer>();
  const follow = () => {
    const scene = viewer.scenes.newest;
    const parts = (scene?.parts ?? []).filter(({ loaded }) =>
      loaded.clouds.some((each) => framesOf(each.cloud)),
    );
    for (const [key, player] of players) {
      const part = parts.find((each) => each.key === key);
      if (part && scene && player.plays(scene.session, part)) continue;
      player.end();
      players.delete(key);
    }
    for (const part of parts) {
      if (!players.has(part.key))
        players.set(part.key, new FramePlayer({ store, viewer }, scene!.session, part, tell));
      players.get(part.key)!.update();
    }
    tell();
  };
  const tell = () => {
    const all = [...players.values()];
    const isFrameAwaited = all.some((player) => player.isAwaited);
    const frameLoad = all.find(({ progress }) => progress)?.progress ?? null;
    const before = store.getState();
    if (isFrameAwaited !== before.isFrameAwaited || frameLoad !== before.frameLoad)
      store.setState({ isFrameAwaited, frameLoad });
  };
  const unsubscribe = store.subscribe((state, before) => {
    const isOther = state.scene !== before.scene || state.sceneTime !== before.sceneTime;
    if (isOther || state.shownFrames !== before.shownFrames) follow();
  });
  follow();
  return () => {
    unsubscribe();
    for (const player of players.values()) player.end();
    store.setState({ isFrameAwaited: false, frameLoad: null });
  };
}

/** A frame on the GPU, or on its way there. */
interface HeldFrame {
  readonly ending: AbortController;
  /** Null while it is loaded. */
  cloud: SplatCloud | null;
}

/** Keeps the frames of a file that are shown now and next on the GPU. */
class FramePlayer {
  readonly #props: PanelProps;
  readonly #session: Session;
  readonly #key: number;
  readonly #source: ShownPart['source'];
  readonly #onChange: () => void;
  readonly #count: number;
  readonly #perS: number;
  readonly #held = new Map<number, HeldFrame>();
  /** Clouds of frames before, which may still be on the screen. */
  readonly #leaving = new Set<SplatCloud>();
  /** Errors of frames that cannot be loaded. */
  readonly #failed = new Map<number, unknown>();
  #hasReported = false;
  readonly #ending = new AbortController();
  #file: SplatFrames | null = null;
  #shown: number;
  #wanted: number;
  #progress: (LoadProgress & { readonly title: string }) | null = null;

  constructor(props: PanelProps, session: Session, part: ShownPart, onChange: () => void) {
    const { key, source, loaded } = part;
    const [{ cloud }] = loaded.clouds;
    const { count, perS } = framesOf(cloud)!;
    this.#props = props;
    this.#session = session;
    this.#key = key;
    this.#source = source;
    this.#onChange = onChange;
    this.#count = count;
    this.#perS = perS;
    this.#shown = loaded.frame ?? 0;
    this.#wanted = this.#shown;
    this.#held.set(this.#shown, { ending: new AbortController(), cloud });
    void this.#open(part);
  }

  /** Whether the frame at the scene's time is neither shown nor known to be damaged. */
  get isAwaited(): boolean {
    return this.#wanted !== this.#shown && !this.#failed.has(this.#wanted);
  }

  /** Bytes of the file so far; null for local files, and once all are there. */
  get progress(): (LoadProgress & { readonly title: string }) | null {
    return this.#progress;
  }

  /** Whether this is the player of `part`, as it is on the GPU of `session`. */
  plays(session: Session, { source, loaded }: ShownPart): boolean {
    const isSame = session === this.#session && source === this.#source;
    return isSame && loaded.clouds[0]?.cloud === this.#held.get(this.#shown)?.cloud;
  }

  /** Shows the frame at the scene's time if it is there, and loads it and the next ones. */
  update(): void {
    const { store, viewer } = this.#props;
    this.#wanted = frameAt(store.getState().sceneTime ?? 0, this.#count, this.#perS);
    this.#destroyLeft();
    this.#hold();
    const error = this.#failed.get(this.#wanted);
    if (error !== undefined) this.#report(error, null);
    const cloud = this.#held.get(this.#wanted)?.cloud;
    if (!cloud || this.#wanted === this.#shown) return;
    this.#shown = this.#wanted;
    // Updates this player again, by the store.
    viewer.scenes.showFrame(this.#key, this.#shown, cloud);
  }

  /** The cloud on the screen stays; the scene owns it. */
  end(): void {
    this.#ending.abort();
    this.#file?.end();
    const shown = this.#held.get(this.#shown)?.cloud;
    for (const { cloud, ending } of this.#held.values()) {
      ending.abort();
      if (cloud !== shown) cloud?.destroy();
    }
    for (const cloud of this.#leaving) cloud.destroy();
  }

  async #open(part: ShownPart): Promise<void> {
    const title = titleOf(this.#source);
    const { signal } = this.#ending;
    const onProgress = (progress: LoadProgress) => {
      const isThere = progress.loadedBytes === progress.totalBytes;
      this.#progress = isThere ? null : { title, ...progress };
      this.#onChange();
    };
    try {
      const file = await openFrameFile(lastingScene(part)!, { signal, onProgress });
      if (signal.aborted) file.end();
      else this.#file = file;
      this.update();
    } catch (error) {
      if (signal.aborted) return;
      for (let frame = 0; frame < this.#count; frame++) this.#failed.set(frame, error);
      this.#report(error, `Only the first frame of ${title} is shown`);
    }
    this.#onChange();
  }

  /** Drops frames that are not needed now or next, and loads missing ones. */
  #hold(): void {
    const next = Array.from(
      { length: Math.min(HELD_FRAMES, this.#count) },
      (_, i) => (this.#wanted + i) % this.#count,
    );
    for (const [frame, { cloud, ending }] of this.#held) {
      if (frame === this.#shown || next.includes(frame)) continue;
      this.#held.delete(frame);
      ending.abort();
      if (cloud) this.#leaving.add(cloud);
    }
    if (!this.#file) return;
    for (const frame of next) {
      const loads = [...this.#held.values()].filter(({ cloud }) => !cloud).length;
      if (loads < LOADS_AT_ONCE && !this.#held.has(frame) && !this.#failed.has(frame)) void this.#load(frame);
    }
  }

  async #load(frame: number): Promise<void> {
    const held: HeldFrame = { ending: new AbortController(), cloud: null };
    this.#held.set(frame, held);
    const { signal } = held.ending;
    try {
      const source = this.#file!.frames[frame];
      const cloud = await this.#session.engine.load(source, { name: source.name, fit: 'auto', signal });
      if (signal.aborted) cloud.destroy();
      else held.cloud = cloud;
    } catch (error) {
      // A lost device has its own page.
      if (signal.aborted || error instanceof DestroyedError) return;
      this.#held.delete(frame);
      this.#failed.set(frame, error);
    }
    if (!signal.aborted) this.update();
    this.#onChange();
  }

  /** Frames that are no longer on the screen, nor in the frame that is drawn next. */
  #destroyLeft(): void {
    const clouds = this.#props.viewer.shownFrame?.frame.clouds;
    if (!clouds) return;
    for (const cloud of this.#leaving) {
      if (clouds.some((shown) => shown.cloud === cloud)) continue;
      this.#leaving.delete(cloud);
      cloud.destroy();
    }
  }

  /** Reports the first error: others mostly have the same reason. */
  #report(error: unknown, title: string | null): void {
    if (this.#hasReported) return;
    this.#hasReported = true;
    const report = reportFailure(error, titleOf(this.#source));
    if (report.isFault) console.error(error);
    const advice = title ? report.advice : 'The frame before is shown in its place.';
    this.#props.store.setState({ failure: { ...report, title: title ?? report.title, advice } });
  }
}
