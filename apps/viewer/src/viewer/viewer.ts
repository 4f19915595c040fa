import {
  ACCURACY_PRESETS,
  type AccuracyChoice,
  type AccuracySettings,
  type AccuracyWish,
  type Camera,
  type ChooseAccuracyOptions,
  InvalidArgumentError,
  isAccuracyWish,
  isSoftwareAdapter,
  perspectiveCamera,
  SplatEngine,
  type SplatView,
  type TextureImage,
  type ViewFrame,
  WebGpuUnavailableError,
} from '@websplatter/core';
import {
  lookAt,
  OrbitControls,
  type OrbitPose,
  poseFromLookAt,
  type Vec3,
} from '../camera/orbit-controls.ts';
import {
  boundingSphere,
  boundsOf,
  depthRange,
  FIRST_FOV_DEGREES,
  firstPose,
  flippedMatrix,
  flippedPoint,
  flippedPose,
  framedPose,
  orbitNear,
  type Sphere,
  verticalFov,
} from '../camera/scene-camera.ts';
import { observeDevicePixelSize } from '../drawing/canvas-size.ts';
import { FrameLoop } from '../drawing/frame-loop.ts';
import { FrameMeter } from '../drawing/frame-meter.ts';
import { hardCaseNameIn } from '../hard-cases/catalogue.ts';
import { reportError } from '../messages/failure-report.ts';
import { defaultSceneName, findBuiltinScene } from '../scene/builtin-scene.ts';
import { droppedWarning, mergedDrops } from '../scene/dropped-splats.ts';
import { type LoadedScene, loadScene, type SceneSource, titleOf } from '../scene/scene-source.ts';
import { type Comparison, type LoadState, sideAccuracy, type ViewerStore } from '../state/store.ts';
import { decodeAccuracy } from '../words/accuracy-text.ts';

/**
 * What to open first, from the page's address: `?file=URL`, `?scene=NAME` and `?scene=hard:NAME`; `?accuracy=` as
 * `encodeAccuracy` writes it.
 */
export interface StartOptions {
  readonly accuracy?: string | null;
  readonly file?: string | null;
  readonly scene?: string | null;
}

interface ShownScene extends LoadedScene {
  /** Of no other scene that this page has shown. */
  readonly id: number;
  /** The clouds of an ended session are gone with it. */
  readonly session: Session;
  readonly source: SceneSource;
  /** Where the scene is, but for stray splats; unflipped. */
  readonly sphere: Sphere;
  /** Where all splats are, unflipped. */
  readonly extent: Sphere;
}

/** What it takes to go back to a scene. */
interface ReplacedScene {
  readonly scene: ShownScene;
  readonly pose: OrbitPose;
  readonly home: OrbitPose;
  readonly fovDegrees: number;
  readonly cameraIndex: number;
  readonly isFlipped: boolean;
}

/** The picture that was drawn last, and what it was drawn of. */
interface DrawnPicture {
  readonly scene: ShownScene;
  /** With everything but its accuracy. */
  readonly frame: ViewFrame & { readonly background: Vec3 };
}

/** The device and what was made on it; replaced as a whole when the device is lost. */
interface Session {
  readonly canvas: HTMLCanvasElement;
  readonly engine: SplatEngine;
  readonly view: SplatView;
  /** Draws the right side of a split picture. */
  right: SplatView | null;
  /** Draws pictures to be read back. */
  probe: SplatView | null;
}

/**
 * The application without its interface: owns the engine, opens scenes, draws when something has changed, and tells
 * the store. React mounts its canvas and calls its commands.
 */
export class Viewer {
  readonly controls: OrbitControls;
  readonly #store: ViewerStore;
  readonly #start: StartOptions;
  readonly #loop: FrameLoop;
  readonly #meter = new FrameMeter();
  #session: Session | null = null;
  #rightCanvas: HTMLCanvasElement | null = null;
  #sessionWaiters: ((session: Session) => void)[] = [];
  /** Starts a session on the mounted canvas; null while none is mounted. */
  #restart: (() => void) | null = null;
  #scene: ShownScene | null = null;
  /** Field of view over the picture's shorter side, where the camera orbits. */
  #fovDegrees = FIRST_FOV_DEGREES;
  /** Scenes that are no longer asked for, but shown until the newest has been drawn. */
  #replaced: ReplacedScene[] = [];
  #loading: AbortController | null = null;
  #background: Vec3 = [0, 0, 0];
  #drawn: DrawnPicture | null = null;
  #frameCount = 0;
  #scenesShown = 0;
  /** Settles when the clouds hold what they were last asked for, as far as they can. */
  #planes: Promise<void> = Promise.resolve();
  /** How often the loop has paused. */
  #pauses = 0;
  /** Of the picture that came to rest last: see `pictureId`. */
  #restedKey = '';

  constructor(store: ViewerStore, start: StartOptions = {}) {
    this.#store = store;
    this.#start = start;
    this.#readAccuracy(start.accuracy ?? null);
    const reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
    this.controls = new OrbitControls({
      onChange: () => this.#loop.request(),
      isMotionReduced: () => reducedMotion.matches,
    });
    this.#loop = new FrameLoop({
      draw: (elapsedMs) => this.#draw(elapsedMs),
      onDrawn: (completedMs) => store.setState({ frameRate: this.#meter.add(completedMs) }),
      onIdle: () => void this.#rest(),
    });
  }

  /** Draws to `canvas` from now on; returns what ends that and frees the GPU. */
  attach(canvas: HTMLCanvasElement): () => void {
    const ended = new AbortController();
    const { signal } = ended;
    const readBackground = () => {
      this.#background = colorOf(canvas);
      this.#loop.request();
    };
    readBackground();
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', readBackground, { signal });
    const stopObserving = observeDevicePixelSize(canvas, ({ widthPx, heightPx }) => {
      this.#store.setState({ widthPx, heightPx });
      this.#loop.request();
    });
    const detachControls = this.controls.attach(canvas);
    this.#restart = () => void this.#startSession(canvas, signal);
    this.#restart();
    return () => {
      ended.abort();
      this.#restart = null;
      stopObserving();
      detachControls();
      this.#endSession();
    };
  }

  /** Draws the right side of split pictures to `canvas` from now on; returns what ends that. */
  attachRight(canvas: HTMLCanvasElement): () => void {
    this.#rightCanvas = canvas;
    this.#createRight();
    this.#loop.request();
    return () => {
      this.#rightCanvas = null;
      this.#session?.right?.destroy();
      if (this.#session) this.#session.right = null;
    };
  }

  /** Draws with `accuracy` from the next picture on; ends a wish. */
  setAccuracy(accuracy: AccuracySettings): void {
    this.#store.setState({ accuracy, wish: null, choice: null });
    this.#applyAccuracy();
    this.#loop.request();
  }

  /** Draws with what is chosen because of `wish` in each scene, by `chooseAccuracy`, until settings are chosen by hand. */
  setWish(wish: AccuracyWish): void {
    this.#store.setState({ wish, choice: null });
    this.#applyAccuracy();
    this.#loop.request();
  }

  /**
   * Measures now what meets the wish in the picture that stands, and draws with it.
   *
   * @throws InvalidArgumentError where there is no wish or no picture; what `SplatView.chooseAccuracy` throws. What was
   *   drawn before stays then.
   */
  async chooseAccuracy(options: ChooseAccuracyOptions): Promise<AccuracyChoice> {
    const drawn = this.#standingPicture();
    const { wish } = this.#store.getState();
    if (!drawn || !wish)
      throw new InvalidArgumentError('chooseAccuracy', 'It takes a wish and a picture that stands.');
    const view = this.#wishingView(drawn.scene.session);
    view.render({ ...drawn.frame, accuracy: wish });
    const choice = await view.chooseAccuracy(options);
    await view.whenDrawn();
    return choice;
  }

  /** Shows two accuracies at once, or with null the chosen one alone again. */
  compare(comparison: Comparison | null): void {
    this.#store.setState({ comparison });
    this.#applyAccuracy();
    this.#loop.request();
  }

  /**
   * Draws the picture that stands now with another accuracy, beside the screen, and reads it back. One at a time.
   *
   * @returns null where no picture stands.
   */
  async readPicture(accuracy: AccuracySettings): Promise<PictureOnBackground | null> {
    await this.#planes;
    const drawn = this.#standingPicture();
    if (!drawn) return null;
    const { session } = drawn.scene;
    session.probe ??= this.#createView(session.engine);
    session.probe.render({ ...drawn.frame, accuracy });
    const image = await session.probe.readPixels();
    return { image, background: drawn.frame.background };
  }

  /** What stands on the screen; null where nothing does. */
  get standing(): StandingPicture | null {
    const drawn = this.#standingPicture();
    return drawn && { engine: drawn.scene.session.engine, frame: drawn.frame };
  }

  /** Opens `source` in place of what is shown, which stays until then; calls off what is being loaded. */
  open(source: SceneSource): void {
    const { status } = this.#store.getState();
    if (status === 'unavailable' || status === 'lost') return;
    this.#store.setState({ error: null, notice: null });
    void this.#load(source);
  }

  /** Calls off what is being loaded; what is shown stays. */
  cancelLoad(): void {
    const { load } = this.#store.getState();
    if (!this.#loading || !load) return;
    this.#store.setState({ notice: `Opening ${load.title} was cancelled.` });
    this.#loading.abort();
  }

  /** Asks for the GPU again after it was lost, and opens what was shown. */
  recover(): void {
    if (this.#store.getState().status !== 'lost') return;
    this.#store.setState({ status: 'starting', statusReason: '' });
    this.#restart?.();
  }

  /** Turns the scene the other way up; the view keeps facing the same side of it. */
  toggleFlip(): void {
    if (!this.#store.getState().scene?.canFlip) return;
    this.#store.setState(({ isFlipped }) => ({ isFlipped: !isFlipped }));
    this.controls.setPose(flippedPose(this.controls.pose), flippedPose(this.controls.home));
  }

  /** Moves the camera, without turning it, so that the whole scene can be seen. */
  frameScene(): void {
    const scene = this.#scene;
    if (!scene) return;
    const { controls } = this;
    controls.glideTo(
      framedPose(controls.pose, this.#placed(scene.sphere), controls.fovYDegrees, this.#aspect()),
    );
  }

  /** Shows the scene's next own camera, or with −1 the one before. */
  stepCamera(by: 1 | -1): void {
    const { scene, cameraIndex } = this.#store.getState();
    const count = scene?.cameras.length ?? 0;
    if (count > 0) this.#showCamera((cameraIndex + by + count) % count);
  }

  /** Moves the view by the key that was pressed; returns whether the key means anything here. */
  handleKey(event: KeyboardEvent): boolean {
    if (event.key !== '[' && event.key !== ']') return this.controls.handleKey(event);
    this.stepCamera(event.key === ']' ? 1 : -1);
    return true;
  }

  async #startSession(canvas: HTMLCanvasElement, signal: AbortSignal): Promise<void> {
    const store = this.#store;
    let engine: SplatEngine;
    try {
      const { wish, accuracy } = store.getState();
      engine = await SplatEngine.create({ accuracy: wish ?? accuracy });
    } catch (error) {
      if (signal.aborted) return;
      const reason = error instanceof Error ? error.message : String(error);
      store.setState({ status: 'unavailable', statusReason: reason, load: null });
      if (!(error instanceof WebGpuUnavailableError)) console.error(error);
      return;
    }
    if (signal.aborted) {
      engine.destroy();
      return;
    }
    engine.device.addEventListener('uncapturederror', (event) => {
      console.error(`WebGPU: ${(event as GPUUncapturedErrorEvent).error.message}`);
    });
    const view = this.#createView(engine, canvas);
    view.onStatistics = (statistics) => store.setState({ statistics });
    const session: Session = { canvas, engine, view, right: null, probe: null };
    this.#session = session;
    this.#createRight();
    void engine.lost.then((info) => {
      if (this.#session === session) this.#lose(info);
    });
    store.setState({
      status: 'running',
      adapterLabel: engine.adapterLabel,
    });
    this.#applyAccuracy();
    for (const resolve of this.#sessionWaiters.splice(0)) resolve(session);
    if (!this.#loading) void this.#load(this.#firstSource(engine));
  }

  /** Null where the newest scene has not been drawn yet, or what was drawn went with its device. */
  #standingPicture(): DrawnPicture | null {
    const drawn = this.#drawn;
    return drawn && drawn.scene === this.#scene && drawn.scene.session === this.#session ? drawn : null;
  }

  #createRight(): void {
    const session = this.#session;
    const canvas = this.#rightCanvas;
    if (session && canvas) session.right ??= this.#createView(session.engine, canvas);
  }

  #createView(engine: SplatEngine, canvas?: HTMLCanvasElement): SplatView {
    const view = engine.createView({ canvas });
    view.onAccuracyChosen = (choice) => this.#takeChoice(engine, choice);
    return view;
  }

  /** A view that is drawn with what was chosen, not with what it is compared with. */
  #wishingView(session: Session): SplatView {
    const { comparison } = this.#store.getState();
    if (comparison?.kind !== 'split' || comparison.left === 'current') return session.view;
    if (comparison.right === 'current' && session.right) return session.right;
    session.probe ??= this.#createView(session.engine);
    return session.probe;
  }

  #takeChoice(engine: SplatEngine, choice: AccuracyChoice): void {
    if (this.#store.getState().wish === null) return;
    this.#store.setState({ accuracy: choice.settings, choice, accuracyNotices: engine.notices });
    // The view has drawn it by itself; the loop tells when it stands.
    this.#frameCount++;
    this.#loop.request();
  }

  #readAccuracy(text: string | null): void {
    try {
      const accuracy = decodeAccuracy(text);
      this.#store.setState(isAccuracyWish(accuracy) ? { wish: accuracy } : { accuracy });
    } catch (error) {
      if (!(error instanceof InvalidArgumentError)) throw error;
      this.#store.setState({ notice: `The address asks for an unknown accuracy. ${error.message}` });
    }
  }

  /**
   * Tells the engine of the accuracy in the store, and the store what comes of it. What clouds do not hold at that
   * precision, or at one that it is compared with, is made or read in the background; the picture follows.
   */
  #applyAccuracy(): void {
    this.#planes = this.#askForPlanes();
  }

  async #askForPlanes(): Promise<void> {
    const session = this.#session;
    if (!session) return;
    const { engine } = session;
    const store = this.#store;
    const { wish, accuracy, comparison } = store.getState();
    const asked = wish ?? accuracy;
    const isCurrent = () => {
      const now = store.getState();
      return (
        this.#session === session && (now.wish ?? now.accuracy) === asked && now.comparison === comparison
      );
    };
    const request = engine.setAccuracy(asked);
    store.setState({
      accuracyNotices: engine.notices,
      // Until it has been measured, what was chosen for the same wish before, or the default.
      ...(wish && { accuracy: engine.accuracy }),
    });
    const problems = (await request).map(({ error }) => error.message);
    const clouds = this.#scene?.clouds ?? [];
    for (const other of comparedWith(comparison)) {
      for (const { cloud } of clouds) {
        if (!isCurrent() || cloud.isDestroyed) return;
        await engine.requestPrecision(cloud, other, { keep: true }).catch((error: Error) => {
          if (error.name !== 'AbortError') problems.push(error.message);
        });
      }
    }
    if (!isCurrent()) return;
    store.setState({ accuracyNotices: [...new Set([...engine.notices, ...problems])] });
    this.#loop.request();
  }

  #endSession(): void {
    this.#loop.stop();
    this.#loading?.abort();
    this.#loading = null;
    const session = this.#session;
    this.#session = null;
    this.#replaced = [];
    // Destroying the engine destroys its clouds and views.
    session?.engine.destroy();
  }

  #lose(info: GPUDeviceLostInfo): void {
    this.#endSession();
    this.#store.setState({
      status: 'lost',
      statusReason: info.message || 'The browser gives no reason.',
      load: null,
      error: null,
      isIdle: true,
    });
  }

  #whenSession(): Promise<Session> {
    const session = this.#session;
    return session ? Promise.resolve(session) : new Promise((resolve) => this.#sessionWaiters.push(resolve));
  }

  /** What was shown before the device was lost; otherwise what the address asks for. */
  #firstSource(engine: SplatEngine): SceneSource {
    if (this.#scene) return this.#scene.source;
    const { file, scene } = this.#start;
    if (file) {
      if (URL.canParse(file, location.href)) return { kind: 'url', url: new URL(file, location.href) };
      this.#store.setState({ notice: `“${file}” is not an address.` });
    }
    const hardCase = hardCaseNameIn(scene);
    if (hardCase !== null) return { kind: 'hard-case', name: hardCase };
    return this.#builtinSource(engine);
  }

  #builtinSource(engine: SplatEngine): SceneSource {
    const { scene: address } = this.#start;
    const name = hardCaseNameIn(address) === null ? address : null;
    const asked = name ? findBuiltinScene(name) : undefined;
    if (name && !asked) this.#store.setState({ notice: `There is no built-in scene “${name}”.` });
    const scene = asked ?? findBuiltinScene(defaultSceneName(isSoftwareAdapter(engine.device.adapterInfo)));
    if (!scene) throw new Error('The default scene is missing.');
    return { kind: 'builtin', scene };
  }

  async #load(source: SceneSource): Promise<void> {
    this.#loading?.abort();
    const loading = new AbortController();
    this.#loading = loading;
    const title = titleOf(source);
    const report = (progress: Omit<LoadState, 'title'>) => {
      if (this.#loading === loading) this.#store.setState({ load: { title, ...progress } });
    };
    report({
      phase: source.kind === 'builtin' || source.kind === 'hard-case' ? 'make' : 'read',
      loadedBytes: 0,
      totalBytes: undefined,
      splats: 0,
    });
    try {
      const session = await this.#whenSession();
      const loaded = await loadScene(session.engine, source, loading.signal, report);
      if (loading.signal.aborted || session !== this.#session) destroyClouds(loaded);
      else this.#show(session, source, loaded);
    } catch (error) {
      if (this.#loading === loading && !loading.signal.aborted) this.#fail(error, title);
    }
    // A newer load, or the end of the session, has taken over.
    if (this.#loading !== loading) return;
    this.#loading = null;
    this.#store.setState({ load: null });
    // An empty window helps nobody: where the first file failed or was called off, the built-in scene comes.
    const session = this.#session;
    if (session && !this.#scene && source.kind !== 'builtin')
      void this.#load(this.#builtinSource(session.engine));
  }

  #fail(error: unknown, title: string): void {
    const report = reportError(error, title);
    if (report.isFault) console.error(error);
    this.#store.setState({ error: report });
  }

  #show(session: Session, source: SceneSource, loaded: LoadedScene): void {
    const previous = this.#scene;
    const isReopened = previous?.source === source;
    const { clouds } = loaded;
    const scene: ShownScene = {
      ...loaded,
      id: ++this.#scenesShown,
      session,
      source,
      sphere: boundingSphere(boundsOf(clouds, 'robustBounds')),
      extent: boundingSphere(boundsOf(clouds, 'bounds')),
    };
    // Clouds of an ended session are gone with it and cannot come back.
    if (previous?.session === session) this.#replaced.push(this.#snapshot(previous));
    this.#setScene(scene);
    this.#applyAccuracy();
    // After the device was lost the view goes on where it was.
    if (!isReopened) this.#showFirstView(scene);
    this.#loop.request();
  }

  #setScene(scene: ShownScene): void {
    const { clouds, source, sphere, about } = scene;
    this.#scene = scene;
    this.controls.distanceRange = { min: sphere.radius * 1e-3, max: sphere.radius * 100 };
    const title = titleOf(source);
    const splats = clouds.reduce((sum, { cloud }) => sum + cloud.count, 0);
    const dropped = mergedDrops(clouds.map(({ cloud }) => cloud.dropped));
    this.#store.setState({
      scene: {
        title,
        clouds: clouds.length,
        splats,
        declaredShDegree: Math.max(0, ...clouds.map(({ cloud }) => cloud.facts.declaredShDegree)),
        shDegree: Math.max(0, ...clouds.map(({ cloud }) => cloud.shDegree)),
        dropped,
        about,
        cameras: Object.keys(scene.ownCameras?.(this.#aspect()) ?? {}),
        // Own cameras show the scene as it is; turned, it would be another one.
        canFlip: scene.ownCameras === null,
      },
      warning: droppedWarning(title, splats, dropped),
      isDroppedVisible: false,
      choice: null,
      effectCosts: null,
    });
  }

  #showFirstView(scene: ShownScene): void {
    const { firstView, ownCameras, sphere, isUpsideDown } = scene;
    this.#store.setState({ isFlipped: isUpsideDown, cameraIndex: 0 });
    if (ownCameras) {
      this.#showCamera(0);
      return;
    }
    this.#fovDegrees = firstView?.fovYDegrees ?? FIRST_FOV_DEGREES;
    const pose = firstView
      ? poseFromLookAt(firstView)
      : firstPose(this.#placed(sphere), this.#fovY(), this.#aspect());
    this.controls.setPose(pose);
  }

  /** Shows an own camera of the scene; moving goes on as an orbit from about there. */
  #showCamera(index: number): void {
    const scene = this.#scene;
    const camera = scene && this.#ownCamera(scene, index);
    if (!camera) return;
    const { pose, fovDegrees } = orbitNear(camera, scene.sphere, this.#aspect());
    this.#fovDegrees = fovDegrees;
    this.#store.setState({ cameraIndex: index });
    this.controls.setPose(pose);
  }

  #ownCamera(scene: ShownScene, index: number): Camera | undefined {
    return Object.values(scene.ownCameras?.(this.#aspect()) ?? {})[index];
  }

  #snapshot(scene: ShownScene): ReplacedScene {
    const { pose, home } = this.controls;
    const { isFlipped, cameraIndex } = this.#store.getState();
    return { scene, pose, home, fovDegrees: this.#fovDegrees, cameraIndex, isFlipped };
  }

  /** The newest scene cannot be drawn: back to the one before it. */
  #takeBack(error: unknown): void {
    const failed = this.#scene;
    const last = this.#replaced.pop();
    this.#fail(error, failed ? titleOf(failed.source) : 'The scene');
    if (!last) return;
    const { scene, pose, home, fovDegrees, cameraIndex, isFlipped } = last;
    this.#setScene(scene);
    this.#fovDegrees = fovDegrees;
    this.#store.setState({ cameraIndex, isFlipped });
    this.controls.setPose(pose, home);
    if (failed) destroyClouds(failed);
  }

  #draw(elapsedMs: number): Promise<unknown> | null {
    const session = this.#session;
    const scene = this.#scene;
    const state = this.#store.getState();
    const { widthPx, heightPx, isFlipped, isIdle, cameraIndex, isOwnCamera, comparison } = state;
    const accuracy = state.wish ?? state.accuracy;
    const split = comparison?.kind === 'split' ? comparison : null;
    if (!session || scene?.session !== session || widthPx === 0) return null;
    this.controls.fovYDegrees = this.#fovY();
    if (this.controls.update(elapsedMs)) this.#loop.request();
    // Where the view has not been moved, or is back, it is the scene's own camera, for this shape of the picture.
    const ownCamera = this.controls.isHome ? this.#ownCamera(scene, cameraIndex) : undefined;
    const background = this.#background;
    const clouds = scene.clouds.map(({ cloud, modelMatrix }) => ({
      cloud,
      modelMatrix: isFlipped ? flippedMatrix(modelMatrix) : modelMatrix,
    }));
    let frame: DrawnPicture['frame'];
    let isSubmitted: boolean;
    const { framesDrawn } = session.engine.counters();
    try {
      frame = { camera: ownCamera ?? this.#orbitCamera(scene), clouds, widthPx, heightPx, background };
      isSubmitted = session.view.render({
        ...frame,
        accuracy: split ? sideAccuracy(split.left, accuracy) : accuracy,
      });
      if (split && session.right?.render({ ...frame, accuracy: sideAccuracy(split.right, accuracy) }))
        isSubmitted = true;
    } catch (error) {
      this.#takeBack(error);
      return null;
    }
    if (!isSubmitted) return null;
    this.#drawn = { scene, frame };
    this.#frameCount++;
    if (state.dock === 'effects') this.#tellEffects(session);
    if (isIdle) this.#store.setState({ isIdle: false });
    if (isOwnCamera !== (ownCamera !== undefined)) this.#store.setState({ isOwnCamera: !isOwnCamera });
    const replaced = this.#replaced.splice(0);
    if (replaced.length > 0) void this.#destroyWhenReplaced(session, replaced);
    // While shaders compile, views go on with the old ones where they can; the loop is not to wait for the new ones.
    const isDrawn = session.engine.counters().framesDrawn > framesDrawn;
    return isDrawn ? session.engine.device.queue.onSubmittedWorkDone() : null;
  }

  async #destroyWhenReplaced(session: Session, replaced: readonly ReplacedScene[]): Promise<void> {
    try {
      await whenComplete(session);
    } catch {
      // The new scene's shaders do not compile: the old one stays.
      return;
    }
    for (const { scene } of replaced) destroyClouds(scene);
  }

  /** Nothing is asked for any more; what is still being compiled may be drawn yet. */
  async #rest(): Promise<void> {
    this.#meter.pause();
    const pause = ++this.#pauses;
    const session = this.#session;
    // A shader that does not compile was reported by the device.
    if (session) await whenComplete(session).catch(() => {});
    // A later pause waits for what was drawn before it, and this one knows nothing of that: it may have begun before there
    // was a scene. On a busy machine it ended while the first frame's shaders were compiling.
    if (pause === this.#pauses && session === this.#session && this.#loop.isResting) this.#becomeIdle();
  }

  #becomeIdle(): void {
    const session = this.#session;
    const drawn = this.#drawn;
    if (!session || !drawn) {
      this.#store.setState({ isIdle: true });
      return;
    }
    const { scene, frame } = drawn;
    const { camera, clouds, background } = frame;
    this.#tellEffects(session);
    const key = keyOfView(scene, frame);
    const isSame = key === this.#restedKey;
    this.#restedKey = key;
    this.#store.setState(({ pictureId }) => ({
      isIdle: true,
      restedFrames: this.#frameCount,
      pictureId: isSame ? pictureId : pictureId + 1,
    }));
    // For tests and other observers of the page: the camera of the picture that stands now, and how many were drawn.
    const { canvas } = session;
    canvas.dataset.frames = String(this.#frameCount);
    canvas.dataset.camera = JSON.stringify({
      viewMatrix: Array.from(camera.viewMatrix),
      projectionMatrix: Array.from(camera.projectionMatrix),
      near: camera.near,
      far: camera.far,
      modelMatrices: clouds.map(({ modelMatrix }) => (modelMatrix ? Array.from(modelMatrix) : null)),
      background,
    });
  }

  #tellEffects({ view }: Session): void {
    const effects = view.effects();
    // Mostly nothing has changed, and then nothing is to be rendered.
    if (JSON.stringify(effects) !== JSON.stringify(this.#store.getState().effects))
      this.#store.setState({ effects });
  }

  #orbitCamera(scene: ShownScene): Camera {
    const { pose, fovYDegrees } = this.controls;
    const { near, far } =
      scene.firstView ?? depthRange(pose, this.#placed(scene.sphere), this.#placed(scene.extent));
    return perspectiveCamera({ ...lookAt(pose), fovYDegrees, aspect: this.#aspect(), near, far });
  }

  #fovY(): number {
    return verticalFov(this.#fovDegrees, this.#aspect());
  }

  /** `sphere` as the scene stands now. */
  #placed(sphere: Sphere): Sphere {
    const { isFlipped } = this.#store.getState();
    return isFlipped ? { center: flippedPoint(sphere.center), radius: sphere.radius } : sphere;
  }

  #aspect(): number {
    const { widthPx, heightPx } = this.#store.getState();
    return widthPx > 0 ? widthPx / heightPx : 1;
  }
}

/** A picture on the screen, and what another one like it can be drawn with. */
export interface StandingPicture {
  readonly engine: SplatEngine;
  /** Without accuracy. */
  readonly frame: ViewFrame;
}

/** A picture as it was read back, without its background, and what it is to be shown on. */
export interface PictureOnBackground {
  readonly image: TextureImage;
  readonly background: Vec3;
}

/** Everything that a picture depends on but its accuracy and background, as text. */
function keyOfView({ id }: ShownScene, { camera, clouds, widthPx, heightPx }: ViewFrame): string {
  const models = clouds.map(({ modelMatrix }) => modelMatrix && Array.from(modelMatrix));
  const { viewMatrix, projectionMatrix } = camera;
  const matrices = [Array.from(viewMatrix), Array.from(projectionMatrix), models];
  return JSON.stringify([id, widthPx, heightPx, matrices]);
}

/** Accuracies that a comparison shows beside the chosen one. */
function comparedWith(comparison: Comparison | null): readonly AccuracySettings[] {
  if (comparison?.kind === 'error') return [ACCURACY_PRESETS.reference];
  if (comparison === null) return [];
  return [comparison.left, comparison.right].filter((side) => side !== 'current');
}

/** When the last picture asked for before this call has been drawn. */
async function whenComplete({ view, right, engine }: Session): Promise<void> {
  await Promise.all([view.whenDrawn(), right?.whenDrawn()]);
  await engine.device.queue.onSubmittedWorkDone();
}

function destroyClouds({ clouds }: LoadedScene): void {
  for (const { cloud } of clouds) cloud.destroy();
}

/** The style sheet's background of `element`, sRGB 0…1. */
function colorOf(element: Element): Vec3 {
  const channels =
    getComputedStyle(element)
      .backgroundColor.match(/[\d.]+/g)
      ?.map(Number) ?? [];
  const [red = 0, green = 0, blue = 0] = channels;
  return [red / 255, green / 255, blue / 255];
}
