import {
  type AccuracyChoice,
  CodeUnavailableError,
  DestroyedError,
  RecoveryPace,
  SplatEngine,
  WebGpuUnavailableError,
} from '@websplatter/core';
import type { ViewerStore } from '../../state/store.ts';
import { type Session, Views } from './session.ts';

export interface SessionEvents {
  readonly onStart: (session: Session) => void;
  /** Called before the GPU is freed, and if the canvas is removed before a session has started. */
  readonly onEnd: () => void;
  readonly onAccuracyChosen: (engine: SplatEngine, choice: AccuracyChoice) => void;
}

/**
 * Owns the engine: requests the GPU, frees it, and restarts after the device was lost, by itself at
 * the pace of `RecoveryPace` or when the user asks.
 */
export class SessionOwner {
  readonly #store: ViewerStore;
  readonly #events: SessionEvents;
  readonly #createEngine: typeof SplatEngine.create;
  #current: Session | null = null;
  /** Starts a session on the mounted canvas; null while none is mounted. */
  #restart: (() => void) | null = null;
  #rightCanvas: HTMLCanvasElement | null = null;
  /** The engine of the first session, if it was requested before there was a canvas. */
  #prepared: Promise<SplatEngine> | null = null;
  #waiters: ((session: Session) => void)[] = [];
  /** Whether any session has started. */
  #hasStarted = false;
  #pace = new RecoveryPace();
  #retryTimer: ReturnType<typeof setTimeout> | undefined;

  /** @param createEngine for tests. */
  constructor(store: ViewerStore, events: SessionEvents, createEngine = SplatEngine.create) {
    this.#store = store;
    this.#events = events;
    this.#createEngine = createEngine;
  }

  /** Null while the GPU is requested and after it was lost. */
  get current(): Session | null {
    return this.#current;
  }

  /** Requests the GPU before there is a canvas. */
  prepare(): void {
    this.#prepared = this.#askForEngine();
    // Callers that await the engine handle the error.
    this.#prepared.catch(() => {});
  }

  whenStarted(): Promise<Session> {
    const session = this.#current;
    return session ? Promise.resolve(session) : new Promise((resolve) => this.#waiters.push(resolve));
  }

  /** Starts a session that draws to `canvas`; the returned function ends it and frees the GPU. */
  attach(canvas: HTMLCanvasElement): () => void {
    const detached = new AbortController();
    this.#restart = () => void this.#start(canvas, detached.signal);
    this.#restart();
    return () => {
      detached.abort();
      clearTimeout(this.#retryTimer);
      this.#restart = null;
      this.#end();
    };
  }

  /** Draws the right side of split images to `canvas` until the returned function is called. */
  attachRight(canvas: HTMLCanvasElement): () => void {
    this.#rightCanvas = canvas;
    if (this.#current) this.#createRight(this.#current.views, canvas);
    return () => {
      this.#rightCanvas = null;
      this.#current?.views.destroyRight();
      this.#store.setState({ rightStatistics: null, rightRasterizer: null });
    };
  }

  /** Requests the GPU again at the user's wish, after it was lost or unavailable. */
  recover(): void {
    const { status } = this.#store.getState();
    if (status !== 'lost' && status !== 'unavailable') return;
    this.#pace = new RecoveryPace();
    clearTimeout(this.#retryTimer);
    // Without a canvas, the status `starting` mounts one, which starts a session.
    this.#tryAgain(status === 'lost' ? 'recovering' : 'starting');
  }

  /** Call it when a complete image is on the screen. */
  confirmRecovery(): void {
    this.#pace.recovered();
  }

  #tryAgain(status: 'starting' | 'recovering'): void {
    this.#store.setState({ status });
    this.#restart?.();
  }

  async #start(canvas: HTMLCanvasElement, signal: AbortSignal): Promise<void> {
    const store = this.#store;
    let engine: SplatEngine | null = null;
    let session: Session;
    try {
      const prepared = this.#prepared;
      this.#prepared = null;
      engine = await (prepared ?? this.#askForEngine());
      if (signal.aborted) {
        engine.destroy();
        return;
      }
      // Throws if the device has been lost already.
      session = this.#sessionOf(engine, canvas);
    } catch (error) {
      engine?.destroy();
      if (signal.aborted) return;
      const reason = error instanceof Error ? error.message : String(error);
      if (!(error instanceof WebGpuUnavailableError || error instanceof DestroyedError)) console.error(error);
      // A GPU that worked before may come back.
      if (this.#hasStarted) this.#becomeLost(reason);
      else {
        const isCodeMissing = error instanceof CodeUnavailableError;
        store.setState({ status: 'unavailable', statusReason: reason, isCodeMissing, load: null });
      }
      return;
    }
    this.#current = session;
    this.#hasStarted = true;
    void engine.lost.then((info) => {
      if (this.#current === session) this.#becomeLost(info.message || 'The browser gives no reason.');
    });
    store.setState({
      status: 'running',
      statusReason: '',
      retryWaitMs: null,
      adapterLabel: engine.adapterLabel,
    });
    this.#events.onStart(session);
    for (const resolve of this.#waiters.splice(0)) resolve(session);
  }

  #askForEngine(): Promise<SplatEngine> {
    const { target, accuracy } = this.#store.getState();
    return this.#createEngine({ accuracy: target ?? accuracy });
  }

  #sessionOf(engine: SplatEngine, canvas: HTMLCanvasElement): Session {
    engine.device.addEventListener('uncapturederror', (event) => {
      console.error(`WebGPU: ${(event as GPUUncapturedErrorEvent).error.message}`);
    });
    const views = new Views(engine, canvas, (choice) => this.#events.onAccuracyChosen(engine, choice));
    views.main.onStatistics = (statistics) => {
      const { rasterizer, detail } = views.main;
      const { drawn: drawnDetail = 'full', movingScale = 1 } = detail ?? {};
      this.#store.setState({ statistics, rasterizer, drawnDetail, movingScale });
    };
    if (this.#rightCanvas) this.#createRight(views, this.#rightCanvas);
    return { canvas, engine, views };
  }

  #createRight(views: Views, canvas: HTMLCanvasElement): void {
    const right = views.createRight(canvas);
    right.onStatistics = (rightStatistics) => {
      this.#store.setState({ rightStatistics, rightRasterizer: right.rasterizer });
    };
  }

  #becomeLost(reason: string): void {
    this.#end();
    const waitMs = this.#pace.next();
    this.#store.setState({ statusReason: reason, load: null, failure: null, isIdle: true });
    if (waitMs === 0) {
      // Recovery mostly succeeds at once, so a notice is enough.
      this.#store.setState({ notice: 'The connection to the GPU was lost. The scene is opened again.' });
      this.#tryAgain('starting');
      return;
    }
    this.#store.setState({ status: 'lost', retryWaitMs: waitMs, isHelpVisible: false });
    if (waitMs !== null) this.#retryTimer = setTimeout(() => this.#tryAgain('recovering'), waitMs);
  }

  #end(): void {
    const session = this.#current;
    this.#current = null;
    this.#events.onEnd();
    // Destroying the engine destroys its clouds and views.
    session?.engine.destroy();
  }
}
