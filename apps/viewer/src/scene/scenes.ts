import { isSoftwareAdapter, type SplatEngine } from '@websplatter/core';
import type { Sphere } from '../camera/scene-bounds.ts';
import type { CameraSnapshot, LinkedCamera, ViewCamera } from '../camera/view-camera.ts';
import { reportFailure } from '../messages/failure-report.ts';
import type { Session } from '../session/session.ts';
import type { SessionOwner } from '../session/session-owner.ts';
import { type Inspecting, NOTHING_INSPECTED } from '../state/inspecting.ts';
import { NO_EFFECTS, type RequestedEffects } from '../state/requested-effects.ts';
import type { LoadState } from '../state/scene-summary.ts';
import type { ViewerStore } from '../state/store.ts';
import { isGpuLost } from '../state/viewer-state.ts';
import { droppedWarning } from './dropped-splats.ts';
import {
  type AddressedScene,
  builtinSource,
  type FirstSource,
  firstSource,
  smallSource,
} from './first-source.ts';
import { fitNotice } from './fit-notice.ts';
import { destroyClouds, type LoadedScene, loadScene } from './load-scene.ts';
import { type SceneSource, titleOf } from './scene-source.ts';
import { type ReplacedScene, type ShownScene, shownScene, summaryOf } from './shown-scene.ts';

export interface ScenesOptions {
  readonly store: ViewerStore;
  readonly sessions: Pick<SessionOwner, 'current' | 'whenStarted' | 'recover'>;
  readonly camera: ViewCamera;
  readonly addressed: AddressedScene;
  /** How to look at what the address asks for; otherwise its first view is shown. */
  readonly linkedCamera?: LinkedCamera | null;
  /** The newest scene is another one: its clouds have to be prepared. The camera still looks at the one before. */
  readonly onClouds: () => void;
  /** The newest scene is ready to be drawn. */
  readonly onShow: () => void;
}

/** What can be shown of the scene that is being loaded. */
interface Preview {
  readonly scene: ShownScene;
  /** Bounds that the camera shows. */
  readonly framed: Sphere;
  /** How the camera looked at the scene before; null if there was none. */
  readonly camera: CameraSnapshot | null;
  /** What panels asked for before it. */
  readonly requested: RequestedEffects;
  readonly inspecting: Inspecting;
}

/** By this part of their radius bounds may change before the camera follows. */
const FRAMED_CHANGE = 0.1;

const Z_UP_NOTICE =
  'By its shape this is ground whose z axis points up. The View panel (V) shows it another way up.';

/** Loads scenes, one at a time, and knows which is to be drawn. */
export class Scenes {
  readonly #options: ScenesOptions;
  #newest: ShownScene | null = null;
  #preview: Preview | null = null;
  /** Scenes that are no longer asked for, but stay on the screen until the newest has been drawn. */
  #replaced: ReplacedScene[] = [];
  #loading: AbortController | null = null;
  /** What a person has asked for, until it has been opened, has failed or was called off. */
  #asked: SceneSource | null = null;
  #shown = 0;
  /** What the address has asked for, if it is the first to be opened. */
  #addressed: SceneSource | null = null;

  constructor(options: ScenesOptions) {
    this.#options = options;
  }

  /** The scene that was opened last, as a whole; its session may have ended. */
  get newest(): ShownScene | null {
    return this.#newest;
  }

  /** The scene to draw: the newest, or what is there of the one that is being loaded. */
  get drawable(): ShownScene | null {
    return this.#preview?.scene ?? this.#newest;
  }

  /** Whether only a part of the scene can be drawn yet. */
  get isPartial(): boolean {
    return this.#preview !== null;
  }

  /**
   * Opens `source` in place of what is shown, which stays until then; calls off what is being loaded. Where the GPU was lost,
   * asks for it again first.
   */
  open(source: SceneSource): void {
    const { store, sessions } = this.#options;
    const state = store.getState();
    if (state.status === 'unavailable') return;
    store.setState({ failure: null, notice: null, lastFile: null });
    if (!isGpuLost(state)) {
      void this.#load(source);
      return;
    }
    this.#asked = source;
    sessions.recover();
  }

  /** Where the GPU was lost: forgets what was shown, which may be what takes the GPU down, and opens a scene that does not. */
  openSmallScene(): void {
    this.#newest = null;
    this.#options.store.setState({ scene: null, warning: null });
    this.open(smallSource());
  }

  /**
   * For a new session: opens what was being opened or shown before the device was lost, otherwise what the address asks for.
   */
  openFirst({ engine }: Session): void {
    if (this.#loading) return;
    const { addressed } = this.#options;
    const first = () => {
      const { source, ...problems } = firstSource(addressed, location.href, isSoftware(engine));
      // Another scene in its place has no such view.
      if (problems.notice === null && problems.failure === null) this.#addressed = source;
      return this.#withNotice({ source, ...problems });
    };
    void this.#load(this.#asked ?? this.#newest?.source ?? first());
  }

  /** Calls off what is being loaded; what is shown stays. */
  cancelLoad(): void {
    const { store } = this.#options;
    const { load } = store.getState();
    if (!this.#loading || !load) return;
    store.setState({ notice: `Opening ${load.title} was cancelled.` });
    this.#loading.abort();
  }

  /** The session ends: loading stops, and its scenes cannot come back. The camera goes back to the newest, which is opened again. */
  endSession(): void {
    this.#loading?.abort();
    this.#loading = null;
    this.#endPreview();
    this.#replaced = [];
  }

  /** The newest scene has been asked of the GPU; the caller destroys the returned scenes when it has been drawn. */
  takeReplaced(): readonly ShownScene[] {
    // If loading fails, the one before is shown again.
    if (this.#preview) return [];
    return this.#replaced.splice(0).map(({ scene }) => scene);
  }

  /** The drawable scene cannot be drawn: goes back to the one before it. */
  takeBack(error: unknown): void {
    if (this.#preview) {
      this.#fail(error, titleOf(this.#preview.scene.source));
      this.#loading?.abort();
      this.#endPreview();
      return;
    }
    const failed = this.#newest;
    const last = this.#replaced.pop();
    this.#fail(error, failed ? titleOf(failed.source) : 'The scene');
    if (!last) return;
    this.#setNewest(last.scene);
    this.#options.camera.restore(last.camera);
    if (failed) destroyClouds(failed);
  }

  async #load(source: SceneSource): Promise<void> {
    const { store, sessions } = this.#options;
    this.#loading?.abort();
    this.#endPreview();
    const loading = new AbortController();
    this.#loading = loading;
    this.#asked = source;
    const title = titleOf(source);
    const report = (progress: Omit<LoadState, 'title'>) => {
      if (this.#loading === loading) store.setState({ load: { title, ...progress } });
    };
    report({
      phase: source.kind === 'builtin' || source.kind === 'hard-case' ? 'make' : 'read',
      loadedBytes: 0,
      totalBytes: undefined,
      splats: 0,
      bytesPerSecond: 0,
    });
    try {
      const session = await sessions.whenStarted();
      const loaded = await loadScene(session.engine, source, {
        signal: loading.signal,
        onProgress: report,
        onPreview: (preview) => {
          if (!loading.signal.aborted && session === sessions.current)
            this.#showPreview(session, source, preview);
        },
      });
      if (loading.signal.aborted || session !== sessions.current) destroyClouds(loaded);
      else this.#show(session, source, loaded);
    } catch (error) {
      if (this.#loading === loading) this.#endPreview();
      if (this.#loading === loading && !loading.signal.aborted) this.#fail(error, title);
    }
    // A newer load, or the end of the session, has taken over.
    if (this.#loading !== loading) return;
    this.#loading = null;
    this.#asked = null;
    store.setState({ load: null });
    const session = sessions.current;
    if (session && this.#newest?.session !== session) this.#fillWindow(session, source);
  }

  /** An empty window helps nobody: opens what was shown before the device was lost, or the built-in scene, in place of `failed`. */
  #fillWindow({ engine }: Session, failed: SceneSource): void {
    const shown = this.#newest?.source;
    if (failed.kind !== 'builtin') {
      void this.#load(shown && shown !== failed ? shown : this.#builtinSource(engine));
      return;
    }
    this.#newest = null;
    this.#options.store.setState({ scene: null });
  }

  #show(session: Session, source: SceneSource, loaded: LoadedScene): void {
    const { camera, onClouds, onShow } = this.#options;
    const previous = this.#newest;
    const isReopened = previous?.source === source;
    const scene = shownScene(++this.#shown, session, source, loaded);
    const preview = this.#preview;
    this.#preview = null;
    // Clouds of an ended session are gone with it and cannot come back.
    if (previous?.session === session)
      this.#replaced.push({ scene: previous, camera: preview?.camera ?? camera.snapshot() });
    this.#setNewest(scene);
    for (const { cloud } of loaded.clouds)
      if (cloud.fit) this.#options.store.setState({ notice: fitNotice(titleOf(source), cloud.fit) });
    if (loaded.isZUp) this.#options.store.setState({ notice: Z_UP_NOTICE });
    if (loaded.refusal) this.#fail(loaded.refusal, titleOf(source));
    onClouds();
    // After the device was lost the view goes on where it was.
    if (!isReopened) {
      if (preview) camera.showFirstViewAgain();
      else this.#showFirstView(source);
    }
    onShow();
  }

  /** The first view of the newest scene, or that of the address if it is what that asks for. */
  #showFirstView(source: SceneSource): void {
    const { camera, linkedCamera, store } = this.#options;
    // They were chosen for another scene, at its scale.
    store.setState({ requested: NO_EFFECTS, inspecting: NOTHING_INSPECTED });
    if (linkedCamera && source === this.#addressed) camera.showLinked(linkedCamera);
    else camera.showFirstView();
  }

  #showPreview(session: Session, source: SceneSource, loaded: LoadedScene): void {
    const { camera, store, onShow } = this.#options;
    const before = this.#preview;
    const isReopened = this.#newest?.source === source;
    const scene = shownScene(++this.#shown, session, source, loaded);
    const hasMoved = !before || isOtherSphere(before.framed, scene.sphere);
    this.#preview = {
      scene,
      framed: hasMoved ? scene.sphere : before.framed,
      camera: before ? before.camera : this.#newest && camera.snapshot(),
      requested: before ? before.requested : store.getState().requested,
      inspecting: before ? before.inspecting : store.getState().inspecting,
    };
    this.#present(scene);
    if (!isReopened) {
      if (!before) this.#showFirstView(source);
      else if (hasMoved) camera.showFirstViewAgain();
    }
    onShow();
  }

  /** Shows the scene again that was shown before the preview. */
  #endPreview(): void {
    const { store, camera, onShow } = this.#options;
    const preview = this.#preview;
    if (!preview) return;
    this.#preview = null;
    if (this.#newest) this.#present(this.#newest);
    else store.setState({ scene: null });
    if (preview.camera) camera.restore(preview.camera);
    store.setState({ requested: preview.requested, inspecting: preview.inspecting });
    onShow();
  }

  #setNewest(scene: ShownScene): void {
    this.#newest = scene;
    this.#present(scene);
  }

  #present(scene: ShownScene): void {
    const { store, camera } = this.#options;
    camera.follow(scene);
    const summary = summaryOf(scene, camera.ownCameraNames);
    store.setState({
      scene: summary,
      warning: droppedWarning(summary.title, summary.splats, summary.dropped),
      isDroppedVisible: false,
      choice: null,
      effectCosts: null,
    });
  }

  #fail(error: unknown, title: string): void {
    const report = reportFailure(error, title);
    if (report.isFault) console.error(error);
    this.#options.store.setState({ failure: report });
  }

  #builtinSource(engine: SplatEngine): SceneSource {
    return this.#withNotice(builtinSource(this.#options.addressed.scene, isSoftware(engine)));
  }

  #withNotice({ source, notice, failure }: FirstSource): SceneSource {
    if (notice !== null) this.#options.store.setState({ notice });
    if (failure !== null) this.#options.store.setState({ failure });
    return source;
  }
}

function isOtherSphere(a: Sphere, b: Sphere): boolean {
  const offset = Math.hypot(...a.center.map((value, axis) => value - b.center[axis]));
  return Math.max(offset, Math.abs(a.radius - b.radius)) > FRAMED_CHANGE * a.radius;
}

function isSoftware({ device }: SplatEngine): boolean {
  return isSoftwareAdapter(device.adapterInfo);
}
