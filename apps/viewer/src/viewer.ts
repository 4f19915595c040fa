import {
  type Camera,
  perspectiveCamera,
  type SplatCloud,
  SplatEngine,
  type SplatView,
  WebGpuUnavailableError,
} from '@websplatter/core';
import { type BuiltinScene, stillLifeCameras } from '@websplatter/scenes';
import { defaultSceneName, findBuiltinScene, makeBuiltinScene } from './builtin-scene.ts';
import { observeDevicePixelSize } from './canvas-size.ts';
import { reportError } from './error-report.ts';
import { baseName } from './format.ts';
import { FrameLoop } from './frame-loop.ts';
import { FrameMeter } from './frame-meter.ts';
import { lookAt, OrbitControls, type OrbitPose, poseFromLookAt, type Vec3 } from './orbit-controls.ts';
import {
  boundingSphere,
  depthRange,
  FIRST_FOV_DEGREES,
  FLIP_MATRIX,
  firstPose,
  flippedPoint,
  flippedPose,
  framedPose,
  type Sphere,
  verticalFov,
} from './scene-camera.ts';
import type { LoadState, ViewerStore } from './store.ts';

/** Where a scene comes from; kept, so that it can be read again. */
export type SceneSource =
  | { readonly kind: 'builtin'; readonly scene: BuiltinScene }
  | { readonly kind: 'file'; readonly file: File }
  | { readonly kind: 'url'; readonly url: URL };

/** What to open first, from the page's address: `?file=URL` and `?scene=NAME`. */
export interface StartOptions {
  readonly file?: string | null;
  readonly scene?: string | null;
}

interface ShownScene {
  /** The clouds of an ended session are gone with it. */
  readonly session: Session;
  readonly source: SceneSource;
  readonly cloud: SplatCloud;
  /** Where the scene is, but for stray splats; unflipped. */
  readonly sphere: Sphere;
  /** Where all splats are, unflipped. */
  readonly extent: Sphere;
  /** Field of view over the picture's shorter side. */
  readonly fovDegrees: number;
  /** Fixed depths, where the scene comes with them. */
  readonly depths: { readonly near: number; readonly far: number } | null;
}

/** What it takes to go back to a scene. */
interface ReplacedScene {
  readonly scene: ShownScene;
  readonly pose: OrbitPose;
  readonly home: OrbitPose;
  readonly isFlipped: boolean;
}

/** The device and what was made on it; replaced as a whole when the device is lost. */
interface Session {
  readonly canvas: HTMLCanvasElement;
  readonly engine: SplatEngine;
  readonly view: SplatView;
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
  #sessionWaiters: ((session: Session) => void)[] = [];
  /** Starts a session on the mounted canvas; null while none is mounted. */
  #restart: (() => void) | null = null;
  #scene: ShownScene | null = null;
  /** Scenes that are no longer asked for, but shown until the newest has been drawn. */
  #replaced: ReplacedScene[] = [];
  #loading: AbortController | null = null;
  #background: Vec3 = [0, 0, 0];
  #drawn: { readonly camera: Camera; readonly isFlipped: boolean; readonly background: Vec3 } | null = null;
  #frameCount = 0;

  constructor(store: ViewerStore, start: StartOptions = {}) {
    this.#store = store;
    this.#start = start;
    const reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
    this.controls = new OrbitControls({
      onChange: () => this.#loop.request(),
      isMotionReduced: () => reducedMotion.matches,
    });
    this.#loop = new FrameLoop({
      draw: (elapsedMs) => this.#draw(elapsedMs),
      onDrawn: (completedMs) => store.setState({ frameRate: this.#meter.add(completedMs) }),
      onIdle: () => this.#becomeIdle(),
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
    const scene = this.#scene;
    if (!scene) return;
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

  async #startSession(canvas: HTMLCanvasElement, signal: AbortSignal): Promise<void> {
    const store = this.#store;
    let engine: SplatEngine;
    try {
      engine = await SplatEngine.create();
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
    const view = engine.createView({ canvas });
    view.onStatistics = (statistics) => {
      store.setState({ statistics });
      // The engine may have learned that it needs more room; it draws nothing where it has not.
      this.#loop.request();
    };
    const session: Session = { canvas, engine, view };
    this.#session = session;
    void engine.lost.then((info) => {
      if (this.#session === session) this.#lose(info);
    });
    store.setState({
      status: 'running',
      adapterLabel: engine.adapterLabel,
      notice: engine.notices[0] ?? null,
    });
    for (const resolve of this.#sessionWaiters.splice(0)) resolve(session);
    if (!this.#loading) void this.#load(this.#firstSource(engine));
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
    const { file } = this.#start;
    if (file) {
      if (URL.canParse(file, location.href)) return { kind: 'url', url: new URL(file, location.href) };
      this.#store.setState({ notice: `“${file}” is not an address.` });
    }
    return this.#builtinSource(engine);
  }

  #builtinSource(engine: SplatEngine): SceneSource {
    const { scene: name } = this.#start;
    const asked = name ? findBuiltinScene(name) : undefined;
    if (name && !asked) this.#store.setState({ notice: `There is no built-in scene “${name}”.` });
    const scene = asked ?? findBuiltinScene(defaultSceneName(isSoftwareAdapter(engine)));
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
      phase: source.kind === 'builtin' ? 'make' : 'read',
      loadedBytes: 0,
      totalBytes: undefined,
      splats: 0,
    });
    try {
      const session = await this.#whenSession();
      const cloud = await loadCloud(session.engine, source, loading.signal, report);
      if (loading.signal.aborted || session !== this.#session) cloud.destroy();
      else this.#show(session, source, cloud);
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

  #show(session: Session, source: SceneSource, cloud: SplatCloud): void {
    const previous = this.#scene;
    const isReopened = previous?.source === source;
    const sphere = boundingSphere(cloud.robustBounds);
    const camera = source.kind === 'builtin' ? stillLifeCameras[0] : null;
    const scene: ShownScene = {
      session,
      source,
      cloud,
      sphere,
      extent: boundingSphere(cloud.bounds),
      fovDegrees: camera?.fovYDegrees ?? FIRST_FOV_DEGREES,
      depths: camera && { near: camera.near, far: camera.far },
    };
    // Clouds of an ended session are gone with it and cannot come back.
    if (previous?.session === session) this.#replaced.push(this.#snapshot(previous));
    this.#setScene(scene);
    // After the device was lost the view goes on where it was.
    if (!isReopened) {
      this.#store.setState({ isFlipped: source.kind !== 'builtin' });
      const pose = camera
        ? poseFromLookAt(camera)
        : firstPose(this.#placed(sphere), this.#fovY(), this.#aspect());
      this.controls.setPose(pose);
    }
    this.#loop.request();
  }

  #setScene(scene: ShownScene): void {
    const { cloud, source, sphere } = scene;
    this.#scene = scene;
    this.controls.distanceRange = { min: sphere.radius * 1e-3, max: sphere.radius * 100 };
    const dropped = Object.values(cloud.dropped).reduce((sum: number, count) => sum + (count ?? 0), 0);
    const { count: splats, shDegree } = cloud;
    this.#store.setState({ scene: { title: titleOf(source), splats, shDegree, droppedSplats: dropped } });
  }

  #snapshot(scene: ShownScene): ReplacedScene {
    const { pose, home } = this.controls;
    return { scene, pose, home, isFlipped: this.#store.getState().isFlipped };
  }

  /** The newest scene cannot be drawn: back to the one before it. */
  #takeBack(error: unknown): void {
    const failed = this.#scene;
    const last = this.#replaced.pop();
    this.#fail(error, failed ? titleOf(failed.source) : 'The scene');
    if (!last) return;
    this.#setScene(last.scene);
    this.#store.setState({ isFlipped: last.isFlipped });
    this.controls.setPose(last.pose, last.home);
    failed?.cloud.destroy();
  }

  #draw(elapsedMs: number): Promise<unknown> | null {
    const session = this.#session;
    const scene = this.#scene;
    const { widthPx, heightPx, isFlipped, isIdle } = this.#store.getState();
    if (!session || scene?.session !== session || widthPx === 0) return null;
    this.controls.fovYDegrees = this.#fovY();
    if (this.controls.update(elapsedMs)) this.#loop.request();
    const camera = this.#camera(scene);
    const modelMatrix = isFlipped ? FLIP_MATRIX : undefined;
    const background = this.#background;
    let isSubmitted: boolean;
    try {
      const clouds = [{ cloud: scene.cloud, modelMatrix }];
      isSubmitted = session.view.render({ camera, clouds, widthPx, heightPx, background });
    } catch (error) {
      this.#takeBack(error);
      return null;
    }
    if (!isSubmitted) return null;
    this.#drawn = { camera, isFlipped, background };
    this.#frameCount++;
    if (isIdle) this.#store.setState({ isIdle: false });
    const replaced = this.#replaced.splice(0);
    return whenComplete(session).then(() => {
      for (const { scene } of replaced) scene.cloud.destroy();
    });
  }

  #becomeIdle(): void {
    this.#meter.pause();
    this.#store.setState({ isIdle: true });
    const canvas = this.#session?.canvas;
    const drawn = this.#drawn;
    if (!canvas || !drawn) return;
    const { camera, isFlipped, background } = drawn;
    // For tests and other observers of the page: the camera of the picture that stands now, and how many were drawn.
    canvas.dataset.frames = String(this.#frameCount);
    canvas.dataset.camera = JSON.stringify({
      viewMatrix: Array.from(camera.viewMatrix),
      projectionMatrix: Array.from(camera.projectionMatrix),
      near: camera.near,
      far: camera.far,
      modelMatrix: isFlipped ? Array.from(FLIP_MATRIX) : null,
      background,
    });
  }

  #camera(scene: ShownScene): Camera {
    const { pose, fovYDegrees } = this.controls;
    const sphere = this.#placed(scene.sphere);
    const depths = scene.depths ?? depthRange(pose, sphere, this.#placed(scene.extent));
    return perspectiveCamera({ ...lookAt(pose), fovYDegrees, aspect: this.#aspect(), ...depths });
  }

  #fovY(): number {
    return verticalFov(this.#scene?.fovDegrees ?? FIRST_FOV_DEGREES, this.#aspect());
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

/** When the last picture asked for has been drawn. */
async function whenComplete({ view, engine }: Session): Promise<void> {
  await view.whenDrawn();
  await engine.device.queue.onSubmittedWorkDone();
}

async function loadCloud(
  engine: SplatEngine,
  source: SceneSource,
  signal: AbortSignal,
  report: (progress: Omit<LoadState, 'title'>) => void,
): Promise<SplatCloud> {
  if (source.kind === 'builtin') {
    const packed = await makeBuiltinScene(source.scene.name, engine.accuracy, signal);
    return engine.addPacked(packed, { name: source.scene.title });
  }
  const name = titleOf(source);
  return engine.load(source.kind === 'file' ? source.file : source.url, { name, signal, onProgress: report });
}

function titleOf(source: SceneSource): string {
  if (source.kind === 'builtin') return source.scene.title;
  return source.kind === 'file' ? source.file.name : baseName(source.url.href);
}

function isSoftwareAdapter({ adapterLabel, device }: SplatEngine): boolean {
  return /swiftshader|llvmpipe/i.test(adapterLabel) || device.adapterInfo?.isFallbackAdapter === true;
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
