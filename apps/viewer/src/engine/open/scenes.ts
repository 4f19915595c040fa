import {
  type FrameSceneOptions,
  isSoftwareAdapter,
  type SceneKind,
  type SplatCloud,
  type SplatEngine,
} from '@websplatter/core';
import type { ViewCamera } from '../../camera/view-camera.ts';
import { NO_EFFECTS } from '../../state/effects.ts';
import { type Edit, NO_HISTORY } from '../../state/history.ts';
import { NOTHING_INSPECTED, withoutSplats } from '../../state/inspecting.ts';
import { type FailureReport, joinedFailures, type Notice, noticeWith } from '../../state/messages.ts';
import type { LinkedCamera } from '../../state/saved-view.ts';
import type { LoadState } from '../../state/scene.ts';
import { type PartLook, PLAIN_LOOK } from '../../state/scene-part.ts';
import { isGpuLost } from '../../state/session.ts';
import type { ViewerStore } from '../../state/store.ts';
import { lazyCode, withCode } from '../../ui/lazy.tsx';
import type { AddressedScene } from '../link/addressed-scene.ts';
import type { Session } from '../show/session.ts';
import type { SessionOwner } from '../show/session-owner.ts';
import { contentKeyOf } from './content-key.ts';
import type { LookFinder } from './first-look.ts';
import { builtinSource, type FirstSource, firstSource, smallSource } from './first-source.ts';
import { loadScene } from './load-scene.ts';
import {
  type AskedPart,
  added,
  arrived,
  askedAgain,
  began,
  completed,
  dropped,
  ended,
  failed,
  isPartial,
  NOTHING_ASKED,
  opened,
  type Preview,
  previewOf,
  putFirst,
  type ReplacedWork,
  replaced,
  stopped,
  waitingOf,
  waits,
  workOn,
} from './load-states.ts';
import { type SceneSource, titleOf, titleOfAll } from './scene-source.ts';
import {
  allClouds,
  type LoadedScene,
  type ReplacedScene,
  SceneFramer,
  type ShownPart,
  type ShownScene,
  shownScene,
  summaryOf,
} from './shown-scene.ts';

export interface ScenesOptions {
  readonly store: ViewerStore;
  readonly sessions: Pick<SessionOwner, 'current' | 'whenStarted' | 'recover'>;
  readonly camera: ViewCamera;
  readonly addressed: AddressedScene;
  /** Camera for the scene of the page's URL; by default its first view is shown. */
  readonly linkedCamera?: LinkedCamera | null;
  /** Files with more bytes are converted for streaming; see `loadKept`. */
  readonly keepAboveBytes?: number;
  /**
   * Looks of the URL's files in order, as links write them; by default files are drawn as saved.
   */
  readonly linkedLooks?: readonly string[];
  /** Has new clouds prepared as they are to be drawn. The camera still has the previous scene. */
  readonly requestPrecisions: () => void;
  /** Has the scene drawn with the next display refresh. */
  readonly requestFrame: () => void;
}

/** About 8.7 million splats of degree 3, which take half a gigabyte of GPU memory and more to load. */
const KEEP_ABOVE_BYTES = 2 ** 31;

const failureReports = lazyCode(() => import('./failure-report.ts'));

/** Calls `reportFailure`, which is fetched with the first failure: most visits have none. */
async function reportedFailure(error: unknown, title: string): Promise<FailureReport> {
  const report: FailureReport = await failureReports().then(
    ({ reportFailure }) => reportFailure(error, title),
    () => ({ title: `${title} cannot be shown`, message: String(error) }),
  );
  if (report.isFault) console.error(error);
  return report;
}

/**
 * Loads files one by one, as a new scene or into the current one, and decides which scene is drawn.
 */
export class Scenes {
  readonly #options: ScenesOptions;
  readonly #framer = new SceneFramer();
  #load = NOTHING_ASKED;
  /** Aborts the search for another view of the newest scene. */
  #framing: AbortController | null = null;
  /** Replaced scenes that stay on the screen until the newest has been drawn. */
  #replaced: ReplacedScene[] = [];
  #cancelled: readonly SceneSource[] = [];
  #shown = 0;
  #keys = 0;

  constructor(options: ScenesOptions) {
    this.#options = options;
  }

  /** The scene opened last, with its completely loaded files; its session may have ended. */
  get newest(): ShownScene | null {
    return this.#load.scene;
  }

  /** The scene to draw: the newest, or the preview of the one being loaded. */
  get drawable(): ShownScene | null {
    return previewOf(this.#load)?.scene ?? this.newest;
  }

  /** Files of the page's URL that are not opened after all, in the order in which they were cancelled. */
  get cancelled(): readonly SceneSource[] {
    return this.#cancelled;
  }

  /** Whether the page embeds the files of its scene and can show no other. */
  get isHeld(): boolean {
    return this.#options.addressed.held !== undefined;
  }

  /** Whether the scene is incomplete, or its first view is about to be found from all its files. */
  get isPartial(): boolean {
    return isPartial(this.#load);
  }

  /** Frames all detail of the scene from the current direction. */
  async frameAll(): Promise<void> {
    const { camera } = this.#options;
    const scene = this.newest;
    const isFound = !scene || this.isPartial || this.#framer.isCurrent(scene);
    if (!isFound) await this.#frameNewest({ up: camera.upInScene });
    camera.frameScene();
  }

  /** Looks at the scene from outside, as at an object, or from inside, as in a room. */
  async lookFrom(kind: SceneKind): Promise<void> {
    const { camera } = this.#options;
    if (this.isPartial) return;
    if (await this.#frameNewest({ kind, up: camera.upInScene })) camera.goToFraming();
  }

  /**
   * Opens `sources` in place of the scene, which stays until the first of them has loaded. Cancels
   * loading in progress. If the GPU was lost, requests it again first.
   */
  open(...sources: readonly SceneSource[]): void {
    this.openPlaced(...sources.map((source) => ({ source })));
  }

  /** Opens files in place of the scene, each with the look that a project gives it. */
  openPlaced(...files: readonly Pick<AskedPart, 'source' | 'linkedLook'>[]): void {
    if (this.#begin(files.length)) this.#replace(files.map((file) => this.#asked(file)));
  }

  /** Opens `sources` beside the files shown or being loaded; a hard case is replaced. */
  add(...sources: readonly SceneSource[]): void {
    const last = this.#load.queue.at(-1) ?? this.newest?.parts[0];
    if (!last || last.source.kind === 'hard-case') this.open(...sources);
    else if (this.#begin(sources.length)) this.#add(sources.map((source) => this.#asked({ source })));
  }

  /** After the loss of a GPU: closes the scene, which may be the cause, and opens a small one. */
  openSmallScene(): void {
    this.#load = { ...this.#load, scene: null };
    this.#options.store.setState({ scene: null, warning: null });
    this.open(smallSource());
  }

  /**
   * Opens the first files of a new session: the files from before the loss of the device, else the
   * files of the page's URL.
   */
  openFirst({ engine }: Session): void {
    const { role, queue, scene } = this.#load;
    if (this.#load.reading) return;
    if (role !== 'replaces' || queue.length === 0)
      this.#load = putFirst(this.#load, scene?.parts.map(askedAgain) ?? []);
    if (this.#load.queue.length === 0) this.#load = putFirst(this.#load, this.#askedByAddress(engine));
    this.#openNext();
  }

  /** Cancels the file being loaded and continues with the queue; the current scene stays. */
  cancelLoad(): void {
    const { store } = this.#options;
    const { load } = store.getState();
    const { reading, queue } = this.#load;
    if (!reading || !load) return;
    this.#noteCancelled(queue[0]);
    store.setState({ notice: `Opening ${load.title} was cancelled.` });
    reading.abort();
  }

  #noteCancelled(...cancelled: readonly AskedPart[]): void {
    const addressed = cancelled.filter(({ isAddressed }) => isAddressed);
    if (addressed.length > 0)
      this.#cancelled = [...this.#cancelled, ...addressed.map(({ source }) => source)];
  }

  /** Removes a file from the scene or the queue. A scene's only file stays. */
  remove(key: number): void {
    const { queue } = this.#load;
    const place = queue.findIndex((asked) => asked.key === key);
    if (place === 0) {
      this.cancelLoad();
      return;
    }
    if (place > 0) {
      this.#noteCancelled(queue[place]);
      this.#load = { ...this.#load, queue: queue.filter((asked) => asked.key !== key) };
      this.#tellQueue();
      return;
    }
    const parts = this.newest?.parts ?? [];
    const left = parts.filter((part) => part.key !== key);
    if (left.length < parts.length && left.length > 0) this.#change(left);
  }

  /** A key for a file that `addAgain` is to open. */
  newKey(): number {
    return ++this.#keys;
  }

  /** Opens files beside the others, under keys of their own: removed ones again, with their looks. */
  addAgain(...parts: readonly Pick<ShownPart, 'key' | 'source' | 'look'>[]): void {
    if (this.#begin(parts.length)) this.#add(parts.map(askedAgain));
  }

  /** Opens a replaced scene again, with its edits and its camera. */
  #bringBack(left: ReplacedWork): void {
    if (!this.#begin(left.parts.length)) return;
    // Edits are kept by the keys of files.
    this.#replace(
      left.parts.map((part, i) => ({
        ...askedAgain(part),
        ...(i === left.parts.length - 1 && { left }),
      })),
    );
  }

  /** How a file is drawn, or will be once it has loaded; undefined if that is not decided yet. */
  lookOf(key: number): PartLook | undefined {
    const preview = previewOf(this.#load)?.part;
    if (preview?.key === key) return preview.look;
    const asked = this.#load.queue.find((each) => each.key === key);
    return asked?.look ?? this.newest?.parts.find((part) => part.key === key)?.look;
  }

  /** Changes how a file is drawn, even while it is only partly loaded, or waits to be opened again. */
  setLook(key: number, change: Partial<PartLook>): void {
    const look = { ...(this.lookOf(key) ?? PLAIN_LOOK), ...change };
    const queue = this.#load.queue.map((asked) => (asked.key === key ? { ...asked, look } : asked));
    this.#load = { ...this.#load, queue };
    const preview = previewOf(this.#load);
    if (preview?.part.key === key) this.#changePreview(preview, { ...preview.part, look });
    else this.#changePart(key, (each) => ({ ...each, look }));
  }

  /** Shows a frame of a file of frames; the caller destroys the cloud of the frame before. */
  showFrame(key: number, frame: number, cloud: SplatCloud): void {
    this.#changePart(key, (part) => ({ ...part, loaded: { ...part.loaded, frame, clouds: [{ cloud }] } }));
    // The cloud has the chosen accuracy's precisions already.
    if (this.#options.store.getState().comparison) this.#options.requestPrecisions();
  }

  #changePart(key: number, changed: (part: ShownPart) => ShownPart): void {
    const parts = this.newest?.parts ?? [];
    if (parts.some((part) => part.key === key))
      this.#change(parts.map((part) => (part.key === key ? changed(part) : part)));
  }

  /**
   * Ends loading with the session. The camera returns to the newest scene, which the next session
   * opens again.
   */
  endSession(): void {
    this.#endLoading();
    this.#replaced = [];
  }

  #endLoading(): void {
    this.#load.reading?.abort();
    this.#framing?.abort();
    this.#endPreview();
    this.#load = stopped(this.#load);
  }

  /**
   * Call it once the newest scene's work is submitted. Returns the clouds of replaced scenes, which
   * the caller destroys.
   */
  takeReplaced(): readonly SplatCloud[] {
    // If loading fails, the previous scene is shown again.
    if (previewOf(this.#load)) return [];
    const kept = this.newest ? allClouds(this.newest) : [];
    return cloudsBesides(
      this.#replaced.splice(0).map(({ scene }) => scene),
      kept,
    );
  }

  /** The drawable scene cannot be drawn: returns to the previous one. */
  takeBack(error: unknown): void {
    const preview = previewOf(this.#load);
    if (preview) {
      void this.#fail(error, titleOf(preview.part.source));
      this.#load.reading?.abort();
      this.#endPreview();
      return;
    }
    const failed = this.newest;
    const last = this.#replaced.pop();
    const source = failed?.parts.at(-1)?.source;
    void this.#fail(error, source ? titleOf(source) : 'The scene');
    if (!last) return;
    this.#load = { ...this.#load, scene: last.scene };
    this.#present(last.scene);
    this.#options.camera.restore(last.camera);
    if (failed) for (const cloud of cloudsBesides([failed], allClouds(last.scene))) cloud.destroy();
  }

  /** Clears earlier messages when the user opens something. Returns whether it can be opened. */
  #begin(count: number): boolean {
    const { store } = this.#options;
    if (store.getState().status === 'unavailable' || count === 0) return false;
    store.setState({ failure: null, notice: null, lastFile: null });
    return true;
  }

  #replace(files: readonly AskedPart[]): void {
    this.#noteCancelled(...this.#load.queue);
    this.#endLoading();
    this.#load = replaced(this.#load, files);
    this.#openAsked();
  }

  #add(files: readonly AskedPart[]): void {
    this.#load = added(this.#load, files);
    this.#openAsked();
  }

  #openAsked(): void {
    const { store, sessions } = this.#options;
    if (isGpuLost(store.getState())) sessions.recover();
    else if (this.#load.reading) this.#tellQueue();
    else this.#openNext();
  }

  #asked(file: Omit<AskedPart, 'key' | 'look'>): AskedPart {
    return { ...file, key: this.newKey(), look: null };
  }

  #askedByAddress(engine: SplatEngine): AskedPart[] {
    const { addressed, linkedLooks = [] } = this.#options;
    const { sources, ...problems } = firstSource(addressed, location.href, isSoftware(engine));
    this.#tell(problems);
    if (problems.failure && !this.#options.store.getState().hasInterface) return [];
    // A fallback scene does not use the URL's view.
    const isAddressed = problems.notice === null && problems.failure === null;
    return sources.map((source, i) =>
      this.#asked({
        source,
        isAddressed,
        // Hard cases are shown as they are.
        linkedLook: isAddressed && source.kind !== 'hard-case' ? linkedLooks[i] : undefined,
      }),
    );
  }

  #openNext(): void {
    const [asked] = this.#load.queue;
    if (!asked) return;
    this.#tellQueue();
    void this.#read(asked);
  }

  async #read(asked: AskedPart): Promise<void> {
    const { store, sessions, camera } = this.#options;
    const reading = new AbortController();
    const { signal } = reading;
    this.#load = began(this.#load, reading);
    // Otherwise a newer load, or the end of the session, has taken over.
    const isCurrent = () => this.#load.reading === reading;
    const { source } = asked;
    const title = titleOf(source);
    const report = (progress: Omit<LoadState, 'title'>) => {
      if (isCurrent()) store.setState({ load: { title, ...progress } });
    };
    report({
      phase: source.kind === 'hard-case' ? 'make' : 'read',
      loadedBytes: 0,
      totalBytes: undefined,
      splats: 0,
      bytesPerSecond: 0,
    });
    try {
      const [session, contentKey] = await Promise.all([sessions.whenStarted(), contentKeyOf(source)]);
      const { lookOf, whenWhole } = await this.#lookFinder(asked);
      const partOf = (loaded: LoadedScene): ShownPart => ({
        key: asked.key,
        source,
        contentKey,
        loaded,
        // The user may have changed the look meanwhile.
        look: this.#load.queue[0].look ?? lookOf(loaded),
      });
      const loaded = await loadScene(session.engine, source, {
        signal,
        keepAboveBytes: this.#options.keepAboveBytes ?? KEEP_ABOVE_BYTES,
        onProgress: report,
        onPreview: (preview) => {
          if (!signal.aborted && session === sessions.current)
            this.#takePreview(session, asked, partOf(preview));
        },
      });
      await whenWhole?.(loaded, { ...camera.framedShape, signal });
      if (signal.aborted || session !== sessions.current)
        for (const { cloud } of loaded.clouds) cloud.destroy();
      else await this.#show(session, asked, partOf(loaded), signal);
    } catch (error) {
      if (isCurrent()) this.#endPreview();
      if (isCurrent() && !signal.aborted) {
        const report = await reportedFailure(error, title);
        if (!isCurrent()) return;
        this.#load = failed(this.#load, report);
        store.setState({ failure: joinedFailures(this.#load.failures) });
      }
    }
    if (isCurrent() && this.#load.queue.length === 1) await this.#complete();
    if (!isCurrent()) return;
    const session = sessions.current;
    this.#load = ended(this.#load, session);
    if (this.#load.queue.length > 0) {
      this.#openNext();
      return;
    }
    store.setState({ load: null });
    if (session && this.#load.stage.at === 'failed') this.#fillWindow(session, asked);
  }

  /** Decides the look of a file: of its parts as they arrive, and again once all of it is there. */
  async #lookFinder({ look, linkedLook }: AskedPart): Promise<LookFinder> {
    const { store } = this.#options;
    const joined = this.#load.role === 'replaces' ? null : this.newest;
    if (look || (!joined && linkedLook === undefined)) return { lookOf: () => look ?? PLAIN_LOOK };
    const { lookFinder } = await import('./first-look.ts');
    const finder = lookFinder(linkedLook, joined && { ...joined, up: store.getState().firstUp });
    if (finder.notice) store.setState({ notice: finder.notice });
    return finder;
  }

  /**
   * Avoids an empty window: replaces `failed` by the scene from before the loss of the device, or
   * by the built-in one.
   */
  #fillWindow({ engine }: Session, failed: AskedPart): void {
    const shown = this.newest?.parts ?? [];
    const hasShown = shown.length > 0 && shown.every(({ key }) => key !== failed.key);
    // A page with only the picture shows no scene but its own.
    const mayFill = hasShown || this.#options.store.getState().hasInterface;
    if (failed.source.kind !== 'builtin' && mayFill) {
      this.#load = putFirst(this.#load, hasShown ? shown.map(askedAgain) : [this.#builtinPart(engine)]);
      this.#openNext();
      return;
    }
    this.#load = { ...this.#load, scene: null };
    this.#options.store.setState({ scene: null });
  }

  /** The scene with `part` added, or with `part` alone. */
  #sceneWith(session: Session, part: ShownPart): ShownScene {
    const { scene: newest, role } = this.#load;
    const preview = previewOf(this.#load);
    // Clouds of an ended session are gone with it.
    const joins = role !== 'replaces' && newest?.session === session;
    const before = joins || this.#isReopened(part) ? newest : null;
    // A file that comes back has its old place.
    const parts = joins ? [...newest.parts, part].toSorted((a, b) => a.key - b.key) : [part];
    // Files that begin a scene have one first view together.
    const isBeginning = role === 'begins' || role === 'completes';
    const frame = before && isBeginning ? { isUpsideDown: before.isUpsideDown } : before;
    const scene = shownScene(++this.#shown, session, parts, frame ?? undefined);
    if (before) this.#framer.keep(before, scene, !joins && before.parts.length === 1);
    else if (preview) this.#framer.keep(preview.scene, scene, true);
    return scene;
  }

  /** Whether the file belonged to the scene from before the loss of the device. */
  #isReopened({ key }: ShownPart): boolean {
    return this.newest?.parts.some((part) => part.key === key) ?? false;
  }

  /** Whether a new scene has no first view yet. */
  #lacksView({ parts, firstView, ownCameras, clouds }: ShownScene): boolean {
    const isFirst = parts.length === 1 && !previewOf(this.#load) && !this.#isReopened(parts[0]);
    return isFirst && !firstView && !ownCameras && clouds.length > 0;
  }

  async #show(session: Session, asked: AskedPart, part: ShownPart, signal: AbortSignal): Promise<void> {
    const { camera, store, requestPrecisions, requestFrame } = this.#options;
    const { loaded } = part;
    const title = titleOf(part.source);
    this.#dropWaiting();
    const scene = this.#sceneWith(session, part);
    if (this.#lacksView(scene)) {
      await this.#frame(scene, signal);
      if (signal.aborted || session !== this.#options.sessions.current) {
        for (const { cloud } of loaded.clouds) cloud.destroy();
        return;
      }
    }
    const previous = this.newest;
    const isReopened = this.#isReopened(part);
    const joins = scene.parts.length > 1;
    const preview = previewOf(this.#load);
    const before = {
      camera: preview?.camera ?? camera.snapshot(),
      work: preview?.work ?? workOn(store.getState()),
    };
    // Clouds of an ended session are gone with it and cannot come back.
    if (previous?.session === session) this.#replaced.push({ scene: previous, camera: before.camera });
    // A scene that is brought back has its own view.
    this.#load = opened(this.#load, scene, isReopened || asked.left !== undefined);
    this.#present(scene);
    for (const { cloud } of loaded.clouds) {
      const { fit } = cloud;
      if (fit) this.#say(({ fitNotice }) => this.#notice(fitNotice(title, fit)));
    }
    if (loaded.refusal)
      void reportedFailure(loaded.refusal, title).then((report) => {
        const message = `${report.title}. ${report.message}`;
        store.setState({ failure: { ...report, title: 'Refused, as it should be', message } });
      });
    if (loaded.sampleFailure)
      void this.#fail(loaded.sampleFailure, title, `Only some splats of ${title} are shown`);
    requestPrecisions();
    if (joins && this.#load.role === 'joins' && asked.look === null) this.#recordAddition(part);
    // Added files do not move the camera. After the loss of the device, the view stays as it was.
    if (joins) store.setState(({ inspecting }) => ({ inspecting: withoutSplats(inspecting) }));
    else if (!isReopened && !preview) this.#showFirstView(asked);
    if (previous && !joins && !isReopened) this.#leave({ parts: previous.parts, ...before });
    if (asked.left) {
      const { work } = asked.left;
      store.setState({ ...work, inspecting: withoutSplats(work.inspecting) });
      camera.restore(asked.left.camera);
    }
    requestFrame();
  }

  /** Undo takes a file that was added out of the scene again. */
  #recordAddition({ key, source }: ShownPart): void {
    const { store } = this.#options;
    let taken: ShownPart | undefined;
    const edit: Edit = {
      name: `addition of ${titleOf(source)}`,
      do: () => taken && this.addAgain(taken),
      undo: () => {
        taken = this.newest?.parts.find((part) => part.key === key);
        this.remove(key);
      },
    };
    void withCode(
      store,
      () => import('../../state/make-edit.ts'),
      ({ recordEdit }) => recordEdit(store, edit),
    );
  }

  /** Offers to bring a replaced scene back if it had edits. */
  #leave(left: ReplacedWork): void {
    const { store } = this.#options;
    const { inspecting } = left.work;
    const { crop, rulers, selecting } = inspecting;
    const isEdited = crop !== null || rulers.length > 0 || selecting.removed.size > 0;
    const title = titleOfAll(left.parts.map(({ source }) => source));
    store.setState({ leftScene: isEdited ? { title, bringBack: () => this.#bringBack(left) } : null });
    if (isEdited) this.#say(({ leftNotice }) => store.setState({ notice: leftNotice(title, inspecting) }));
  }

  /** All files are open: finds the first view of a new scene again, from all of them. */
  async #complete(): Promise<void> {
    const { camera } = this.#options;
    const { role } = this.#load;
    this.#load = completed(this.#load);
    if (this.isPartial && (await this.#frameNewest())) camera.showFirstViewAgain();
    const framing = this.newest && this.#framer.framingOf(this.newest);
    const isNew = role === 'begins' || role === 'completes';
    if (isNew && framing && camera.isFoundFirst)
      this.#say(({ framingNotice }) => this.#notice(framingNotice(framing)));
  }

  /**
   * Finds a view of the newest scene as it is drawn now, for the camera. Returns whether there is
   * one.
   */
  async #frameNewest(wishes?: FrameSceneOptions): Promise<boolean> {
    const { camera, requestFrame } = this.#options;
    const scene = this.newest;
    if (!scene || scene.ownCameras) return false;
    this.#framing?.abort();
    const framing = new AbortController();
    this.#framing = framing;
    const isFound = await this.#frame(scene, framing.signal, wishes);
    if (!isFound || this.newest !== scene || previewOf(this.#load)) return false;
    camera.follow(this.#framer.subjectOf(scene));
    requestFrame();
    return true;
  }

  /**
   * Finds the first view of a scene and returns whether there is one. If not, a notice says so, and
   * the camera falls back to the bounds.
   */
  async #frame(scene: ShownScene, signal: AbortSignal, wishes: FrameSceneOptions = {}): Promise<boolean> {
    const { camera, store, sessions } = this.#options;
    try {
      await this.#framer.frame(scene, { ...camera.framedShape, ...wishes, signal });
      return !signal.aborted;
    } catch (error) {
      // Nobody waits for the result if the session has ended or a preview passes its splats to the
      // next one.
      const isGone = scene.clouds.some(({ cloud }) => cloud.isDestroyed || cloud.isHeld);
      if (signal.aborted || isGone || scene.session !== sessions.current) return false;
      const title = titleOfAll(scene.parts.map(({ source }) => source));
      const { message } = await reportedFailure(error, title);
      if (signal.aborted) return false;
      store.setState({
        notice: `No first view of ${title} was found. ${message} The whole scene is shown instead.`,
      });
      return false;
    }
  }

  /** Shows the newest scene's first view, or the URL's camera if the URL names this scene. */
  #showFirstView({ isAddressed }: AskedPart): void {
    const { camera, linkedCamera, store } = this.#options;
    // Effects and inspections belong to the previous scene and its scale.
    store.setState({
      requested: NO_EFFECTS,
      inspecting: NOTHING_INSPECTED,
      ...NO_HISTORY,
      selectedPart: null,
    });
    if (linkedCamera && isAddressed) camera.showLinked(linkedCamera);
    else camera.showFirstView();
  }

  /** Shows a preview; the first preview of a new scene waits for its first view. */
  #takePreview(session: Session, asked: AskedPart, part: ShownPart): void {
    const scene = this.#sceneWith(session, part);
    if (!this.#lacksView(scene)) {
      this.#showPreview(scene, asked, part);
      return;
    }
    const begun = waitingOf(this.#load)?.framing;
    const framing = begun ?? new AbortController();
    this.#load = waits(this.#load, { scene, asked, part, framing });
    if (!begun) void this.#framePreview(framing.signal);
  }

  /** Finds the first view of the waiting preview, then shows the newest preview. */
  async #framePreview(signal: AbortSignal): Promise<void> {
    for (let framed = waitingOf(this.#load); framed; framed = waitingOf(this.#load)) {
      const { scene } = framed;
      await this.#frame(scene, signal);
      const newest = waitingOf(this.#load);
      if (signal.aborted || !newest) return;
      const isReplaced = scene.clouds.some(({ cloud }) => cloud.isDestroyed || cloud.isHeld);
      if (!isReplaced || this.#framer.isCurrent(scene)) {
        if (newest !== framed) this.#framer.keep(scene, newest.scene, true);
        this.#showPreview(newest.scene, newest.asked, newest.part);
        return;
      }
      // The next preview to arrive is framed instead.
      if (newest === framed) this.#load = dropped(this.#load);
    }
  }

  /** Newer data replaces a preview that waits for its first view. */
  #dropWaiting(): void {
    const waiting = waitingOf(this.#load);
    if (!waiting) return;
    waiting.framing.abort();
    this.#load = dropped(this.#load);
  }

  #showPreview(scene: ShownScene, asked: AskedPart, part: ShownPart): void {
    const { camera, store, requestFrame } = this.#options;
    const before = previewOf(this.#load);
    const { camera: view, work } = before ?? {
      camera: this.newest && camera.snapshot(),
      work: workOn(store.getState()),
    };
    this.#load = arrived(this.#load, { scene, part, camera: view, work });
    this.#present(scene);
    const joins = scene.parts.length > 1;
    if (!before && !joins && !this.#isReopened(part)) this.#showFirstView(asked);
    requestFrame();
  }

  /** Shows the scene from before the preview. */
  #endPreview(): void {
    const { store, camera, requestFrame } = this.#options;
    this.#dropWaiting();
    const preview = previewOf(this.#load);
    if (!preview) return;
    this.#load = dropped(this.#load);
    if (this.newest) this.#present(this.newest);
    else store.setState({ scene: null });
    // A preview beside other files has changed no effects and has not moved the camera.
    const hasJoined = preview.scene.parts.length > 1;
    if (preview.camera && !hasJoined) camera.restore(preview.camera);
    if (!hasJoined) store.setState(preview.work);
    requestFrame();
  }

  /** Shows the newest scene with fewer files, or with files that look different. */
  #change(parts: readonly ShownPart[]): void {
    const { camera } = this.#options;
    const before = this.newest;
    if (!before) return;
    const isSmaller = parts.length < before.parts.length;
    if (isSmaller) this.#replaced.push({ scene: before, camera: camera.snapshot() });
    const id = isSmaller ? ++this.#shown : before.id;
    const scene = shownScene(id, before.session, parts, before);
    this.#load = { ...this.#load, scene };
    this.#framer.keep(before, scene, false);
    const preview = previewOf(this.#load);
    // A preview that replaces the scene shows none of its files.
    if (preview && this.#load.role === 'replaces') return;
    if (preview) this.#changePreview(preview, preview.part);
    else this.#presentChanged(scene);
  }

  #changePreview(preview: Preview, part: ShownPart): void {
    const scene = this.#sceneWith(preview.scene.session, part);
    this.#load = arrived(this.#load, { ...preview, part, scene });
    this.#presentChanged(scene);
  }

  #presentChanged(scene: ShownScene): void {
    const { camera, store, requestFrame } = this.#options;
    camera.follow(this.#framer.subjectOf(scene));
    store.setState(({ inspecting }) => ({
      scene: summaryOf(scene, camera.ownCameraNames),
      inspecting: withoutSplats(inspecting),
    }));
    requestFrame();
  }

  #present(scene: ShownScene): void {
    const { store, camera } = this.#options;
    camera.follow(this.#framer.subjectOf(scene));
    const summary = summaryOf(scene, camera.ownCameraNames);
    const isOther = store.getState().scene?.contentKey !== summary.contentKey;
    store.setState({
      scene: summary,
      ...(isOther && { sceneTime: null, isScenePlaying: false }),
      warning: null,
      isDroppedVisible: false,
      choice: null,
      effectCosts: null,
    });
    if (Object.keys(summary.dropped).length > 0)
      this.#say(({ droppedWarning }) => {
        const warning = droppedWarning(summary.title, summary.splats, summary.dropped);
        if (warning && store.getState().scene?.contentKey === summary.contentKey) store.setState({ warning });
      });
  }

  /** @param headline replaces the report's own title. */
  async #fail(error: unknown, title: string, headline?: string): Promise<void> {
    const report = await reportedFailure(error, title);
    this.#options.store.setState({ failure: headline ? { ...report, title: headline } : report });
  }

  #builtinPart(engine: SplatEngine): AskedPart {
    const { sources, ...problems } = builtinSource(this.#options.addressed.scene, isSoftware(engine));
    this.#tell(problems);
    return this.#asked({ source: sources[0] });
  }

  #notice(added: string | Notice | null): void {
    if (added !== null) this.#options.store.setState(({ notice }) => ({ notice: noticeWith(notice, added) }));
  }

  #tell({ notice, failure }: Pick<FirstSource, 'notice' | 'failure'>): void {
    this.#notice(notice);
    if (failure !== null) this.#options.store.setState({ failure });
  }

  /** Few loads need these sentences: their code is fetched on demand. */
  #say(say: (notices: typeof import('./scene-notices.ts')) => void): void {
    void withCode(this.#options.store, () => import('./scene-notices.ts'), say);
  }

  #tellQueue(): void {
    const waiting = this.#load.queue.slice(1).map(({ key, source }) => ({ key, title: titleOf(source) }));
    this.#options.store.setState({ waiting });
  }
}

/** Clouds of `scenes` that are not `kept`. */
function cloudsBesides(scenes: readonly ShownScene[], kept: readonly SplatCloud[]): SplatCloud[] {
  return [...new Set(scenes.flatMap(allClouds))].filter((cloud) => !kept.includes(cloud));
}

function isSoftware({ device }: SplatEngine): boolean {
  return isSoftwareAdapter(device.adapterInfo);
}
