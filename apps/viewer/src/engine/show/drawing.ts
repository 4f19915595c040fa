import {
  type Camera,
  DestroyedError,
  type Detail,
  type FrameRequest,
  type SplatCloud,
  type SplatView,
} from '@websplatter/core';
import type { EffectUse } from '@websplatter/core/effects';
import { flippedMatrix } from '../../camera/flip.ts';
import type { ViewCamera } from '../../camera/view-camera.ts';
import { detailOfFrames, sideDrawn } from '../../state/accuracy.ts';
import {
  CLOUD_EFFECT_OWNERS,
  EFFECT_OWNERS,
  NO_EFFECTS,
  type RequestedEffects,
} from '../../state/effects.ts';
import type { MeasuredRate } from '../../state/frames.ts';
import type { ViewerState, ViewerStore } from '../../state/store.ts';
import type { Vec3 } from '../../state/vec3.ts';
import { awaitsViewMode } from '../../state/view-mode.ts';
import type { Scenes } from '../open/scenes.ts';
import { cloudKeys, type ShownScene } from '../open/shown-scene.ts';
import { FrameLoop } from './frame-loop.ts';
import type { Session } from './session.ts';
import type { SessionOwner } from './session-owner.ts';

/** The frame rate is a mean over at most this many frames. */
const WINDOW_FRAMES = 30;
/** Longest time covered by the mean, ms: a longer mean lags noticeably. */
const WINDOW_MS = 1000;

/**
 * Measures the pace of frames that are drawn only on demand: the pause between two runs is not a
 * slow frame. All times are in milliseconds of one clock.
 */
export class FrameMeter {
  #completedMs: number[] = [];

  /** The last frame has been drawn and no other is requested: the next one starts a new run. */
  pause(): void {
    this.#completedMs = [];
  }

  /** A frame was drawn at `completedMs`. Returns null for the first of a run, without a pace. */
  add(completedMs: number): MeasuredRate | null {
    const times = this.#completedMs;
    times.push(completedMs);
    // Two frames are kept however slow they are.
    while (times.length > 2 && (times.length > WINDOW_FRAMES + 1 || completedMs - times[0] > WINDOW_MS)) {
      times.shift();
    }
    const frameMs = (completedMs - times[0]) / (times.length - 1);
    return frameMs > 0 ? { frameMs, framesPerSecond: 1000 / frameMs } : null;
  }
}

export interface DrawingOptions {
  readonly store: ViewerStore;
  readonly sessions: Pick<SessionOwner, 'current' | 'confirmRecovery'>;
  readonly scenes: Scenes;
  readonly camera: ViewCamera;
}

/** A frame, and the scene that it shows. */
interface DrawnFrame {
  readonly scene: ShownScene;
  /** The request without its accuracy. */
  readonly frame: FrameRequest & { readonly background: Vec3; readonly detail: Detail };
  /** The camera as if no panel covered the picture. */
  readonly centred: Camera;
  /** Whether the scene is the other way up. */
  readonly isFlipped: boolean;
}

/** `performance` entry from the navigation to the first picture of a scene, or of a part of it. */
const FIRST_PICTURE = 'first picture';

/** Draws the scene when something changes, and writes to the store when the image comes to rest. */
export class Drawing {
  readonly #options: DrawingOptions;
  readonly #loop: FrameLoop;
  readonly #meter = new FrameMeter();
  #background: Vec3 = [0, 0, 0];
  /** Rebuilt when panels request other effects. */
  #joined = { requested: NO_EFFECTS, byCloud: new Map<string, readonly EffectUse[]>() };
  /** How many frames the engine had drawn when a frame that was waited for was added to the pace. */
  #pacedFrames = 0;
  /** The newest frame that was asked for. */
  #drawn: DrawnFrame | null = null;
  /** The frame on the canvas: an older one while a frame is drawn in parts. */
  #shown: DrawnFrame | null = null;
  #frameCount = 0;
  #hasPicture = false;
  /** Message of the error that a frame was requested for. */
  #received = '';
  /** How often the loop has paused. */
  #pauses = 0;
  /** `imageKey` of the image that came to rest last. */
  #restedKey = '';

  constructor(options: DrawingOptions) {
    this.#options = options;
    this.#loop = new FrameLoop({
      draw: (elapsedMs) => this.#draw(elapsedMs),
      onDrawn: (completedMs) => {
        this.#notePicture();
        options.store.setState({ frameRate: this.#meter.add(completedMs) });
      },
      onIdle: () => void this.#rest(),
    });
  }

  /** Requests a frame for the next display refresh. */
  request(): void {
    this.#loop.request();
  }

  /** Ends drawing with the session; nothing is on the screen any more. */
  stop(): void {
    this.#loop.stop();
  }

  setBackground(color: Vec3): void {
    this.#background = color;
    this.#loop.request();
  }

  /** Counts a frame that a view drew by itself and wakes the loop, which reports the next rest. */
  countOwnFrame(): void {
    this.#frameCount++;
    this.#loop.request();
  }

  /**
   * The frame on the screen; null before the newest scene is drawn and after the device was lost.
   */
  get shown(): DrawnFrame | null {
    const { scenes, sessions } = this.#options;
    const shown = this.#shown;
    return shown && shown.scene === scenes.newest && shown.scene.session === sessions.current ? shown : null;
  }

  /** Whether everything that was asked for is on the screen, effects that had to compile included. */
  get isAtRest(): boolean {
    return this.#loop.isResting && this.#options.store.getState().isIdle;
  }

  #draw(elapsedMs: number): Promise<unknown> | null {
    const { store, sessions, scenes, camera } = this.#options;
    const session = sessions.current;
    const scene = scenes.drawable;
    const { widthPx, isFlipped } = store.getState();
    if (!session || scene?.session !== session || widthPx === 0) return null;
    if (awaitsViewMode(store.getState())) return null;
    if (camera.update(elapsedMs)) this.#loop.request();
    const { ownCamera } = camera;
    const { framesDrawn } = session.engine.counters();
    let frame: DrawnFrame['frame'];
    let isSubmitted: boolean;
    let callMs: number;
    try {
      frame = this.#frameOf(scene, ownCamera ?? camera.orbitCamera);
      const beganMs = performance.now();
      isSubmitted = this.#render(session, frame);
      callMs = performance.now() - beganMs;
    } catch (error) {
      scenes.takeBack(error);
      return null;
    }
    // Also if nothing has to be drawn: a whole scene looks as its last part does.
    const drawn = { scene, frame, centred: ownCamera ?? camera.centredCamera, isFlipped };
    this.#drawn = drawn;
    const replaced = scenes.takeReplaced();
    if (replaced.length > 0) void destroyWhenReplaced(session, replaced);
    if (!isSubmitted) {
      this.#show(drawn);
      return null;
    }
    this.#frameCount++;
    this.#report(session, { isOwnCamera: ownCamera !== undefined, lastRender: { elapsedMs: callMs } });
    // Views draw with old shaders, if they can, while new ones compile. The loop does not wait for
    // the compilation.
    const isDrawn = session.engine.counters().framesDrawn > framesDrawn;
    if (!isDrawn) {
      void this.#showWhenDrawn(session, drawn);
      return null;
    }
    this.#show(drawn);
    return session.engine.device.queue.onSubmittedWorkDone();
  }

  /** `drawn` is on the canvas, which the browser shows together with overlays that follow it now. */
  #show(drawn: DrawnFrame): void {
    if (drawn === this.#shown) return;
    this.#shown = drawn;
    const { store } = this.#options;
    store.setState(({ shownFrames }) => ({ shownFrames: shownFrames + 1 }));
  }

  /** For a frame that is drawn in parts, or waits for shaders or for a frame that is. */
  async #showWhenDrawn({ engine, views }: Session, drawn: DrawnFrame): Promise<void> {
    const { store, sessions } = this.#options;
    try {
      await views.main.whenDrawn();
    } catch (error) {
      this.#receive(error as Error);
      return;
    }
    if (sessions.current?.engine !== engine) return;
    this.#show(drawn);
    // Requests that a newer one replaced are answered together with it.
    const { framesDrawn } = engine.counters();
    if (framesDrawn === this.#pacedFrames) return;
    this.#pacedFrames = framesDrawn;
    store.setState({ frameRate: this.#meter.add(performance.now()) });
  }

  /**
   * Requests a frame because the views have kept an error, which their next call of `render` throws.
   * Once for each message: an error may come back with each frame.
   */
  #receive(error: Error): void {
    // The end of a session or a cloud is no fault.
    if (error instanceof DestroyedError || error.message === this.#received) return;
    this.#received = error.message;
    this.#loop.request();
  }

  #frameOf(scene: ShownScene, camera: DrawnFrame['frame']['camera']): DrawnFrame['frame'] {
    const state = this.#options.store.getState();
    const { widthPx, heightPx, isFlipped, requested, sceneTime } = state;
    if (requested !== this.#joined.requested) this.#joined = { requested, byCloud: new Map() };
    const keys = cloudKeys(scene);
    const clouds = scene.clouds.map(({ cloud, modelMatrix, opacity }, i) => ({
      cloud,
      opacity,
      time: sceneTime ?? undefined,
      modelMatrix: isFlipped ? flippedMatrix(modelMatrix) : modelMatrix,
      effects: this.#effectsOf(keys[i]),
    }));
    const detail = detailOfFrames(state);
    return { camera, clouds, widthPx, heightPx, detail, background: this.#background };
  }

  #effectsOf(cloudKey: string): readonly EffectUse[] {
    const { requested, byCloud } = this.#joined;
    const effects = byCloud.get(cloudKey) ?? joinedEffects(requested, cloudKey);
    byCloud.set(cloudKey, effects);
    return effects;
  }

  /**
   * Draws both sides of a split image, or the only one; returns whether work was or will be
   * submitted.
   */
  #render({ views }: Session, frame: DrawnFrame['frame']): boolean {
    const { target, accuracy: settings, comparison } = this.#options.store.getState();
    const chosen = { accuracy: target ?? settings, detail: frame.detail };
    // Forced if the detail changes: a view reports only its last frame, with the reason why a
    // detail has no effect.
    const asked = { ...frame, force: frame.detail !== this.#drawn?.frame.detail };
    if (comparison?.kind !== 'split') return views.main.render({ ...asked, ...chosen });
    const isLeftSubmitted = views.main.render({ ...asked, ...sideDrawn(comparison.left, chosen) });
    const isRightSubmitted = views.right?.render({ ...asked, ...sideDrawn(comparison.right, chosen) });
    return isLeftSubmitted || isRightSubmitted === true;
  }

  #report({ views }: Session, changes: Pick<ViewerState, 'isOwnCamera' | 'lastRender'>): void {
    const { store } = this.#options;
    const { dock } = store.getState();
    // Reasons that differ only in numbers, as while a slider is dragged, are published at rest.
    if (dock === 'effects') this.#listEffects(views.main, (effects) => effects.map(({ isOn }) => isOn));
    store.setState({ isIdle: false, ...changes });
  }

  /** The loop has paused. Frames whose shaders still compile follow later. */
  async #rest(): Promise<void> {
    const { sessions } = this.#options;
    const pause = ++this.#pauses;
    const session = sessions.current;
    if (session) {
      await session.views.whenComplete().then(
        () => this.#notePicture(),
        (error) => this.#receive(error),
      );
    }
    // Only the newest pause may report: an older one may have begun before there was a scene. On a
    // busy machine, it ended while the shaders of the first frame were compiling.
    if (pause === this.#pauses && session === sessions.current && this.#loop.isResting) this.#becomeIdle();
  }

  #becomeIdle(): void {
    const { store, sessions, scenes } = this.#options;
    this.#meter.pause();
    if (this.#drawn) this.#show(this.#drawn);
    // More of the scene is on its way.
    if (scenes.isPartial) return;
    const session = sessions.current;
    // The last frame may be gone, for example a preview whose loading was cancelled.
    const drawn = this.shown;
    if (!session || !drawn) {
      store.setState({ isIdle: true });
      return;
    }
    this.#listEffects(session.views.main, (effects) => effects);
    const key = imageKey(drawn);
    const isSame = key === this.#restedKey;
    this.#restedKey = key;
    store.setState(({ imageId }) => ({
      isIdle: true,
      restedFrames: this.#frameCount,
      imageId: isSame ? imageId : imageId + 1,
    }));
    sessions.confirmRecovery();
  }

  /** A picture is on the screen. */
  #notePicture(): void {
    if (this.#hasPicture || !this.#drawn) return;
    this.#hasPicture = true;
    performance.measure(FIRST_PICTURE);
  }

  /** @param told what must have changed in the list: mostly nothing has, and React need not render. */
  #listEffects(view: SplatView, told: (effects: ViewerState['effects']) => unknown): void {
    const { store } = this.#options;
    const effects = view.effects();
    if (JSON.stringify(told(effects)) !== JSON.stringify(told(store.getState().effects)))
      store.setState({ effects });
  }
}

/** Key of an image: all that it depends on except accuracy, background and covering panels. */
function imageKey({ scene, frame, centred }: DrawnFrame): string {
  const { clouds, widthPx, heightPx, detail } = frame;
  const models = clouds.map(({ modelMatrix }) => modelMatrix && Array.from(modelMatrix));
  const parts = scene.parts.map(({ key, look, loaded }) => [key, look.isHidden, look.opacity, loaded.frame]);
  const effects = clouds.map((cloud) =>
    cloud.effects?.map(({ effect, options, selection, reason }) => [
      effect.name,
      options,
      selection?.version,
      reason,
    ]),
  );
  const { viewMatrix, projectionMatrix } = centred;
  const matrices = [Array.from(viewMatrix), Array.from(projectionMatrix), models];
  return JSON.stringify([scene.id, widthPx, heightPx, detail, matrices, parts, effects]);
}

async function destroyWhenReplaced({ views }: Session, replaced: readonly SplatCloud[]): Promise<void> {
  try {
    await views.whenComplete();
  } catch {
    // The new scene cannot be drawn, which `#rest` reports: the old one stays.
    return;
  }
  for (const cloud of replaced) cloud.destroy();
}

/**
 * Merges the effects that all panels request for a cloud. Volumes of several panels act
 * one after another. For any other effect requested twice, the panel that is last in the lists of owners
 * wins. While a view mode recolours splats, only the marks of a selection change their colours.
 *
 * @param cloudKey one of `cloudKeys`.
 */
export function joinedEffects(requested: RequestedEffects, cloudKey: string): readonly EffectUse[] {
  const byName = new Map<string, EffectUse>();
  const own = requested['view-mode'];
  const isColored = own.some(({ hooks }) => hooks.color !== undefined);
  const uses = [
    ...EFFECT_OWNERS.flatMap((owner) => requested[owner]),
    ...CLOUD_EFFECT_OWNERS.flatMap((owner) => requested[owner].get(cloudKey) ?? []),
  ];
  for (const use of uses) {
    if (isColored && !own.includes(use) && recolorsAll(use)) continue;
    const { name } = use.effect;
    const before = byName.get(name);
    byName.set(name, before?.joined?.(use) ?? use);
  }
  return [...byName.values()];
}

function recolorsAll({ effect, hooks }: EffectUse): boolean {
  return hooks.color !== undefined && !effect.takesSelection;
}
