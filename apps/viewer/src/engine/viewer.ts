import {
  type AccuracyChoice,
  type AccuracySettings,
  type AccuracyTarget,
  type ChooseAccuracyOptions,
  DEFAULT_ACCURACY,
  DestroyedError,
  type Detail,
  type FixedDetail,
  type FrameRequest,
  InvalidArgumentError,
  isAccuracyTarget,
  isFixedDetail,
  isSoftwareAdapter,
  resolveAccuracy,
  type SplatEngine,
  type SplatPick,
  type SplatView,
  type TextureImage,
} from '@websplatter/core';
import { observeTheme } from '@websplatter/kit/theme';
import { ViewCamera } from '../camera/view-camera.ts';
import type { Comparison, Drawn } from '../state/accuracy.ts';
import type { EffectOwner, RequestedEffects } from '../state/effects.ts';
import type { ViewerStore } from '../state/store.ts';
import type { Vec3 } from '../state/vec3.ts';
import { FileMemory } from './keep/file-memory.ts';
import type { AddressedScene } from './link/addressed-scene.ts';
import type { LinkedStart } from './link/linked-start.ts';
import { Scenes } from './open/scenes.ts';
import { allClouds } from './open/shown-scene.ts';
import { Drawing } from './show/drawing.ts';
import { Precisions } from './show/precisions.ts';
import type { Session } from './show/session.ts';
import { SessionOwner } from './show/session-owner.ts';

/** The start that the page's URL asks for. */
export interface StartOptions extends AddressedScene {
  readonly linked?: LinkedStart;
  /** Files with more bytes are converted for streaming. */
  readonly keepAboveBytes?: number;
}

/** Panels read the store and call the viewer's commands. */
export interface PanelProps {
  readonly store: ViewerStore;
  readonly viewer: Viewer;
}

/** The frame on the screen, and the engine that can draw variations of it. */
export interface ShownFrame {
  readonly engine: SplatEngine;
  /** The request without its accuracy. */
  readonly frame: FrameRequest;
  /** The request with the camera as if no panel covered the picture, for saving it. */
  readonly centred: FrameRequest;
  /** Whether the scene is the other way up. */
  readonly isFlipped: boolean;
}

/** An image read back without its background, and the background shown behind it. */
export interface ImageOnBackground {
  readonly image: TextureImage;
  readonly background: Vec3;
}

/**
 * The application without its interface: it connects session, scenes, camera and drawing, and
 * writes their state to the store. React mounts its canvases and calls its commands.
 */
export class Viewer {
  readonly camera: ViewCamera;
  readonly scenes: Scenes;
  /** The file that was opened last. */
  readonly files: FileMemory;
  readonly #store: ViewerStore;
  readonly #sessions: SessionOwner;
  readonly #precisions: Precisions;
  readonly #drawing: Drawing;

  constructor(store: ViewerStore, start: StartOptions = {}) {
    this.#store = store;
    // Fetched on demand: the first picture needs none of it.
    this.files = new FileMemory(store, () =>
      import('./keep/kept-files.ts').then(({ KEPT_FILES }) => KEPT_FILES),
    );
    const { linked } = start;
    if (linked) store.setState({ ...linked.comparison, viewMode: linked.viewMode });
    const background = linked?.background;
    if (background) store.setState(({ look }) => ({ look: { ...look, background } }));
    if (linked?.detail) store.setState({ detail: linked.detail, isDetailChosen: true });
    if (linked?.notice) store.setState({ notice: linked.notice });
    const accuracy = linked?.accuracy;
    if (accuracy) store.setState(isAccuracyTarget(accuracy) ? { target: accuracy } : { accuracy });
    const reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
    this.camera = new ViewCamera(store, {
      onChange: () => this.#drawing.request(),
      isMotionReduced: () => reducedMotion.matches,
      onDoubleTap: (xPart, yPart) => void this.focusAt(xPart, yPart),
    });
    this.#sessions = new SessionOwner(store, {
      onStart: (session) => this.#startSession(session),
      onEnd: () => {
        this.scenes.endSession();
        this.#drawing.stop();
      },
      onAccuracyChosen: (engine, choice) => this.#takeChoice(engine, choice),
    });
    this.scenes = new Scenes({
      store,
      sessions: this.#sessions,
      camera: this.camera,
      addressed: start,
      linkedCamera: linked?.camera,
      linkedLooks: linked?.looks,
      keepAboveBytes: start.keepAboveBytes,
      requestPrecisions: () => this.#precisions.request(),
      requestFrame: () => this.#drawing.request(),
    });
    this.#precisions = new Precisions({
      store,
      sessions: this.#sessions,
      clouds: () => (this.scenes.newest ? allClouds(this.scenes.newest) : []),
      onHeld: () => this.#drawing.request(),
    });
    const { camera, scenes } = this;
    this.#drawing = new Drawing({ store, sessions: this.#sessions, scenes, camera });
    // If the code cannot be fetched, all splats are drawn in motion as well.
    import('./show/whole-frames.ts').then(
      ({ observeWholeFrames }) => observeWholeFrames(store, () => this.#hasLevels),
      () => {},
    );
    // Observers of the page, such as its tests, read its state here.
    dispatchEvent(new CustomEvent('viewer', { detail: { viewer: this, store } }));
  }

  /** Requests the GPU before there is a canvas. */
  prepare(): void {
    this.#sessions.prepare();
  }

  /** Draws to `canvas` from now on; the returned function ends that and frees the GPU. */
  attach(canvas: HTMLCanvasElement): () => void {
    const stops = [
      observeBackground(canvas, this.#store, (color) => this.#drawing.setBackground(color)),
      observeDevicePixelSize(canvas, ({ widthPx, heightPx }) => {
        this.#store.setState({ widthPx, heightPx });
        this.#drawing.request();
      }),
      this.camera.controls.attach(canvas),
      this.#sessions.attach(canvas),
    ];
    return () => {
      for (const stop of stops) stop();
    };
  }

  /** Draws the right side of split images to `canvas` until the returned function is called. */
  attachRight(canvas: HTMLCanvasElement): () => void {
    const detach = this.#sessions.attachRight(canvas);
    this.#drawing.request();
    return detach;
  }

  /** Requests the GPU again after it was lost or unavailable, and opens the last scene. */
  recover(): void {
    this.#sessions.recover();
  }

  /** Draws with `accuracy` from the next frame on; ends a target. */
  setAccuracy(accuracy: AccuracySettings): void {
    this.#store.setState({ accuracy, target: null, choice: null });
    this.followSettings();
  }

  /** Draws with `detail` from the next frame on. */
  setDetail(detail: Detail): void {
    this.#store.setState({ detail, isDetailChosen: true });
    this.#drawing.request();
  }

  /** Shows a moving scene at a time from the next frame on. */
  setSceneTime(sceneTime: number): void {
    this.#store.setState({ sceneTime });
    this.#drawing.request();
  }

  /** Draws with `uses` from the next frame on, in place of `owner`'s last ones. */
  setEffects<Owner extends EffectOwner>(owner: Owner, uses: RequestedEffects[Owner]): void {
    this.#store.setState(({ requested }) => ({ requested: { ...requested, [owner]: uses } }));
    this.#drawing.request();
  }

  /** Cancels reading and conversion for the requested accuracy. */
  cancelPreparing(): void {
    this.#precisions.cancel();
    this.#drawing.request();
  }

  /**
   * Draws scenes with `chooseAccuracy`'s settings for `target`, until the user chooses settings.
   */
  setTarget(target: AccuracyTarget): void {
    this.#store.setState({ target, choice: null });
    this.followSettings();
  }

  /** Shows two accuracies at once, or with null the chosen one alone again. */
  compare(comparison: Comparison | null): void {
    this.#store.setState({ comparison });
    this.followSettings();
  }

  /** Draws with the store's settings of the picture; call it after they have been set there. */
  followSettings(): void {
    this.#precisions.request();
    this.#drawing.request();
  }

  /**
   * Measures which settings meet the target for the frame on the screen, and draws with them.
   *
   * @throws InvalidArgumentError without a target or a frame; errors of `SplatView.chooseAccuracy`.
   * Then the accuracy stays as it was.
   */
  async chooseAccuracy(options: ChooseAccuracyOptions): Promise<AccuracyChoice> {
    const shown = this.#drawing.shown;
    const { target, comparison } = this.#store.getState();
    if (!shown || !target)
      throw new InvalidArgumentError('chooseAccuracy', 'It takes a target and a frame on the screen.');
    const view = shown.scene.session.views.targeting(comparison);
    view.render({ ...shown.frame, accuracy: target });
    const choice = await view.chooseAccuracy(options);
    await view.whenDrawn();
    return choice;
  }

  /** The view with the chosen settings, not the compared ones; undefined while there is no GPU. */
  get chosenView(): SplatView | undefined {
    return this.#sessions.current?.views.targeting(this.#store.getState().comparison);
  }

  /** The canvas with the picture; null while there is no GPU. */
  get canvas(): HTMLCanvasElement | null {
    return this.#sessions.current?.canvas ?? null;
  }

  /** The engine; null while there is no GPU. */
  get engine(): SplatEngine | null {
    return this.#sessions.current?.engine ?? null;
  }

  /** Calls `focusAt` with the middle of the image. */
  async focusMiddle(): Promise<void> {
    await this.focusAt(...this.camera.middle);
  }

  /**
   * Centres the splat at a place of the image, and orbits it from then on. `xPart` and `yPart` are
   * fractions of the image from its top left. Does nothing if there is no splat.
   */
  async focusAt(xPart: number, yPart: number): Promise<void> {
    const pick = await this.pickAt(xPart, yPart);
    if (pick) this.camera.focus(pick.point);
  }

  /** The splat that contributes most at `xPart`, `yPart` from the image's top left, or null. */
  pickAt(xPart: number, yPart: number): Promise<SplatPick | null> {
    return this.askShown((view, { widthPx, heightPx }) => view.pick(xPart * widthPx, yPart * heightPx));
  }

  /**
   * The answer of the view that draws the frame on the screen; null if that frame has gone by then, or
   * the view cannot answer, which a notice says.
   */
  async askShown<Answer>(
    ask: (view: SplatView, frame: FrameRequest) => Promise<Answer | null>,
  ): Promise<Answer | null> {
    const shown = this.#drawing.shown;
    if (!shown) return null;
    // The session may end, or another scene be shown, before the GPU answers.
    const isShown = () => this.#drawing.shown?.scene === shown.scene;
    try {
      const answer = await ask(shown.scene.session.views.main, shown.frame);
      return isShown() ? answer : null;
    } catch (error) {
      if (isShown() && !(error instanceof DestroyedError))
        this.#store.setState({ notice: (error as Error).message });
      return null;
    }
  }

  /** The frame on the screen; null if there is none. */
  get shownFrame(): ShownFrame | null {
    const shown = this.#drawing.shown;
    if (!shown) return null;
    const { scene, frame, centred, isFlipped } = shown;
    const detail = this.#drawnDetail;
    const drawn = { ...frame, detail };
    return { engine: scene.session.engine, frame: drawn, centred: { ...drawn, camera: centred }, isFlipped };
  }

  /** See `Drawing`. */
  get isAtRest(): boolean {
    return this.#drawing.isAtRest;
  }

  /**
   * Draws a variation of the frame on the screen to a texture and reads it back. One call at a
   * time.
   *
   * @param drawn changes to the frame; its detail is by default the one on the screen.
   * @returns null if nothing is on the screen.
   */
  async readImage(drawn: Pick<Drawn, 'accuracy'> & Partial<Drawn>): Promise<ImageOnBackground | null> {
    await this.#precisions.whenHeld();
    const shown = this.#drawing.shown;
    if (!shown) return null;
    const { probe } = shown.scene.session.views;
    probe.render({ ...shown.frame, detail: this.#drawnDetail, ...drawn });
    const image = await probe.readPixels();
    return { image, background: shown.frame.background };
  }

  /**
   * The chosen detail, or the one found for an outcome: other views would have to search for it.
   */
  get #drawnDetail(): FixedDetail {
    const { detail } = this.#store.getState();
    return isFixedDetail(detail) ? detail : (this.chosenView?.detail?.drawn ?? 'full');
  }

  /** Whether the scene can be drawn with fewer splats. */
  get #hasLevels(): boolean {
    const { newest } = this.scenes;
    const { recordPrecision } = this.#store.getState().accuracy;
    // The paper's records cannot hold opacities above 1, which merged splats have.
    return recordPrecision !== 'paper' && !!newest && allClouds(newest).some((cloud) => !cloud.levelsLack);
  }

  #startSession(session: Session): void {
    this.#takeDefaultOf(session);
    this.#precisions.request();
    this.scenes.openFirst(session);
  }

  /** Applies the device's default accuracy, unless the URL or the user has chosen one. */
  #takeDefaultOf({ engine }: Session): void {
    const { accuracy, defaultAccuracy, target } = this.#store.getState();
    const suited = defaultAccuracyOn(isSoftwareAdapter(engine.device.adapterInfo));
    const isUntouched = target === null && accuracy === defaultAccuracy;
    this.#store.setState({ defaultAccuracy: suited, ...(isUntouched && { accuracy: suited }) });
  }

  #takeChoice(engine: SplatEngine, choice: AccuracyChoice): void {
    if (this.#store.getState().target === null) return;
    this.#store.setState({ accuracy: choice.settings, choice, accuracyNotices: engine.notices });
    // The view has drawn it by itself.
    this.#drawing.countOwnFrame();
  }
}

/**
 * Default accuracy of a device: the fastest known settings that are at least as exact as the
 * engine's default. A CPU converts 16-bit floats slowly, so a software adapter is fastest with the
 * most exact settings.
 */
export function defaultAccuracyOn(isSoftwareAdapter: boolean): AccuracySettings {
  return resolveAccuracy(isSoftwareAdapter ? 'reference' : DEFAULT_ACCURACY);
}

/**
 * Sets the background of `element` and calls `onColor` with it, sRGB 0…1. Repeats after each choice
 * and, for the theme's background, when the colour scheme changes. Returns a function that stops
 * this.
 */
function observeBackground(
  element: HTMLElement,
  store: ViewerStore,
  onColor: (color: Vec3) => void,
): () => void {
  const report = () => onColor(backgroundOf(element));
  const apply = () => {
    const { background } = store.getState().look;
    element.style.backgroundColor = background === 'theme' ? '' : background;
    report();
  };
  apply();
  const unsubscribe = store.subscribe(({ look }) => look.background, apply);
  const stop = observeTheme(report);
  return () => {
    unsubscribe();
    stop();
  };
}

function backgroundOf(element: Element): Vec3 {
  const channels =
    getComputedStyle(element)
      .backgroundColor.match(/[\d.]+/g)
      ?.map(Number) ?? [];
  const [red = 0, green = 0, blue = 0] = channels;
  return [red / 255, green / 255, blue / 255];
}

interface CanvasSize {
  readonly widthPx: number;
  readonly heightPx: number;
}

/** Chromium reports the box in CSS pixels under an emulated density (developer tools, tests). */
function isPlausible(boxPx: number, cssPx: number): boolean {
  return Math.abs(boxPx - cssPx * devicePixelRatio) <= 1;
}

/**
 * Reports the size of `element` in device pixels, now and whenever it changes: by layout, by zoom,
 * or by moving to a screen of another density. Returns a function that stops this.
 */
function observeDevicePixelSize(element: Element, onSize: (size: CanvasSize) => void): () => void {
  let lastCss = { width: 0, height: 0 };
  const report = (width: number, height: number) =>
    onSize({ widthPx: Math.max(1, Math.round(width)), heightPx: Math.max(1, Math.round(height)) });
  const reportScaled = () => report(lastCss.width * devicePixelRatio, lastCss.height * devicePixelRatio);
  let hasDevicePixelBox = true;
  const observer = new ResizeObserver((entries) => {
    const entry = entries.at(-1);
    if (!entry) return;
    const box = entry.devicePixelContentBoxSize?.[0];
    hasDevicePixelBox = box !== undefined;
    lastCss = entry.contentRect;
    // Exact: at fractional scales, a rounded CSS size would make the browser resample the image.
    if (box && isPlausible(box.inlineSize, lastCss.width)) report(box.inlineSize, box.blockSize);
    else reportScaled();
  });
  try {
    observer.observe(element, { box: 'device-pixel-content-box' });
  } catch {
    // Safari does not know this box.
    hasDevicePixelBox = false;
    observer.observe(element);
  }

  // Without that box, only queries notice a change of density. Each query matches one density.
  const stop = new AbortController();
  const watchDensity = () => {
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener(
      'change',
      () => {
        if (!hasDevicePixelBox) reportScaled();
        watchDensity();
      },
      { once: true, signal: stop.signal },
    );
  };
  watchDensity();
  return () => {
    observer.disconnect();
    stop.abort();
  };
}
