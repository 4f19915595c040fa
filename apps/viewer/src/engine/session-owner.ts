import {
  type AccuracyChoice,
  CodeUnavailableError,
  DestroyedError,
  RecoveryPace,
  SplatEngine,
  WebGpuUnavailableError,
} from '@websplatter/core';
import type { ViewerStore } from '../state/store.ts';
import type { Session } from './session.ts';
import { Views } from './views.ts';

export interface SessionEvents {
  readonly onStart: (session: Session) => void;
  /** The GPU is freed next. Also called where no session came about before the canvas went. */
  readonly onEnd: () => void;
  readonly onAccuracyChosen: (engine: SplatEngine, choice: AccuracyChoice) => void;
}

/**
 * Owns the engine: asks for the GPU, frees it, and starts anew after the device was lost: by itself
 * at the pace of `RecoveryPace`, or when a person asks.
 */
export class SessionOwner {
  readonly #store: ViewerStore;
  readonly #events: SessionEvents;
  readonly #createEngine: typeof SplatEngine.create;
  #current: Session | null = null;
  /** Starts a session on the mounted canvas; null while none is mounted. */
  #restart: (() => void) | null = null;
  #rightCanvas: HTMLCanvasElement | null = null;
  /** The engine of the first session, if it was asked for before there was a canvas. */
  #prepared: Promise<SplatEngine> | null = null;
  #waiters: ((session: Session) => void)[] = [];
  /** Whether there has been a GPU. */
  #hasStarted = false;
  #pace = new RecoveryPace();
  #retryTimer: ReturnType<typeof setTimeout> | undefined;

  /** @param createEngine for tests. */
  constructor(store: ViewerStore, events: SessionEvents, createEngine = SplatEngine.create) {
    this.#store = store;
    this.#events = events;
    this.#createEngine = createEngine;
  }

  /** Null while the GPU is asked for, and after it was lost. */
  get current(): Session | null {
    return this.#current;
  }

  /** Asks for the GPU, so that it is there when a canvas is. */
  prepare(): void {
    this.#prepared = this.#askForEngine();
    // Those who take it find out.
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

  /** A person asks for the GPU again, after it was lost or could not be had. */
  recover(): void {
    const { status } = this.#store.getState();
    if (status !== 'lost' && status !== 'unavailable') return;
    this.#pace = new RecoveryPace();
    clearTimeout(this.#retryTimer);
    // Without a canvas, `starting` brings it back, and with it a session.
    this.#tryAgain(status === 'lost' ? 'recovering' : 'starting');
  }

  /** A whole image is on the screen. */
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
      // A GPU that was there may come back.
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
      this.#store.setState({ statistics, rasterizer, drawnDetail: detail?.drawn ?? 'full' });
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
      // Mostly it succeeds at once: no page says so.
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
