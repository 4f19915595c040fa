import { adapterLabel, type SplatEngine, type SplatView, WebSplatterError } from '@websplatter/core';
import { createEngine, describePixel } from '@websplatter/core/inspect';
import { SplatMorph } from '@websplatter/core/own-data';
import { WatchedDevice } from '../run-device.ts';
import { firstDifference } from '../run-images.ts';
import { Chance } from './chance.ts';
import {
  type CloudChange,
  type CloudRecipe,
  changeCloud,
  makeCloud,
  randomAccuracy,
  randomCamera,
  randomDetail,
  randomEdit,
  randomEffects,
  randomPlacing,
  randomPrecision,
  randomRecipe,
  randomSize,
  requestOf,
  type SoakCloud,
  type SoakView,
} from './soak-scene.ts';

export interface SoakOptions {
  /** `navigator.gpu`, or another source of a fresh adapter per request, for one device each. */
  readonly gpu: Pick<GPU, 'requestAdapter'>;
  /** Whole number that seeds all random choices. */
  readonly seed: number;
  readonly frames: number;
  /** Number of frames between comparisons with a fresh engine's picture; default 20. */
  readonly compareEvery?: number;
  /** Returns the bytes of JavaScript objects in use after a garbage collection; default: not checked. */
  readonly heapBytes?: () => number;
  readonly signal?: AbortSignal;
  readonly onFrame?: (frame: number) => void;
  /** Changes a fresh engine's picture, for tests that a difference is noticed. */
  readonly doctor?: (picture: Float32Array) => void;
}

export interface SoakReport {
  readonly adapter: string;
  readonly seed: number;
  readonly frames: number;
  readonly elapsedMs: number;
  /** Number of steps of each kind. */
  readonly steps: Readonly<Record<string, number>>;
  /** Number of pictures that were compared bit for bit with a fresh engine's picture. */
  readonly pictures: number;
  /** Most bytes of GPU memory, and bytes at the end without clouds and views. */
  readonly gpuBytes: { readonly most: number; readonly atRest: number };
  /** Bytes in use after the first tenth of the frames, and in the end; null if unknown. */
  readonly heapBytes: { readonly early: number; readonly end: number } | null;
  /** Faults, with the number of the frame. */
  readonly failures: readonly string[];
}

/** More clouds take longer to draw, and find no more faults than three. */
const MOST_CLOUDS = 3;
/** Small enough that the GPU packs the rows of every file of some hundred splats. */
const INGEST_MIN_ROWS = 200;

/**
 * Most by which JavaScript objects in use may grow after the first tenth of the frames. Code and
 * shaders that only some steps need took up to 5 MiB in soaks of 150 frames.
 */
const HEAP_GROWTH_BYTES = 16 * 2 ** 20;

interface Step {
  readonly name: string;
  /** Relative frequency of the step. */
  readonly weight: number;
  run(soak: Soak, chance: Chance): Promise<void> | void;
}

/** Everything that may happen between two frames. */
const STEPS: readonly Step[] = [
  { name: 'orbit', weight: 30, run: (soak, chance) => soak.orbit(chance.within(-0.3, 0.3)) },
  { name: 'turn', weight: 10, run: (soak, chance) => soak.turnTo(chance.vector(2)) },
  {
    name: 'jump',
    weight: 6,
    run: (soak, chance) => {
      soak.shown.camera = randomCamera(chance);
    },
  },
  {
    name: 'resize',
    weight: 5,
    run: (soak, chance) => {
      soak.shown = { ...soak.shown, size: randomSize(chance) };
    },
  },
  {
    name: 'accuracy',
    weight: 6,
    run: (soak, chance) => {
      soak.shown.accuracy = randomAccuracy(chance);
    },
  },
  {
    name: 'detail',
    weight: 4,
    run: (soak, chance) => {
      soak.shown.detail = randomDetail(chance);
    },
  },
  {
    name: 'sort',
    weight: 2,
    run: (soak, chance) => {
      soak.shown.sortBy = chance.of(['auto', 'depth', 'distance'] as const);
    },
  },
  {
    name: 'background',
    weight: 2,
    run: (soak, chance) => {
      soak.shown.background = [chance.within(0, 1), chance.within(0, 1), chance.within(0, 1)];
    },
  },
  {
    name: 'effects',
    weight: 8,
    run: (soak, chance) => soak.place(chance, () => ({ effects: randomEffects(chance) })),
  },
  { name: 'place', weight: 6, run: (soak, chance) => soak.place(chance, () => randomPlacing(chance)) },
  { name: 'add', weight: 6, run: (soak, chance) => soak.add(chance) },
  { name: 'remove', weight: 4, run: (soak, chance) => soak.remove(chance) },
  { name: 'abort a load', weight: 3, run: (soak, chance) => soak.abortLoad(chance) },
  {
    name: 'precision',
    weight: 4,
    run: (soak, chance) => soak.change(chance, () => ({ precision: randomPrecision(chance) })),
  },
  {
    name: 'edit',
    weight: 8,
    run: (soak, chance) => soak.change(chance, ({ set }) => randomEdit(chance, set)),
  },
  { name: 'levels', weight: 2, run: (soak, chance) => soak.change(chance, () => 'levels') },
  { name: 'morph', weight: 4, run: (soak, chance) => soak.morph(chance) },
  { name: 'pick', weight: 2, run: (soak, chance) => soak.pick(chance) },
  { name: 'other view', weight: 6, run: (soak) => soak.swapViews() },
  { name: 'new view', weight: 2, run: (soak) => soak.renewView() },
  { name: 'clear', weight: 1, run: (soak) => soak.clear() },
  { name: 'lose the device', weight: 2, run: (soak, chance) => soak.loseDevice(chance) },
];

/**
 * Draws frames while cameras, clouds, sizes, settings and effects change at random and devices are
 * lost. Checks that no state leaks: pictures equal a fresh engine's pictures bit for bit, GPU memory
 * returns to its first size, JavaScript's memory stays bounded, and the GPU reports no error. All
 * choices follow from the seed. The first failure ends the soak.
 *
 * @throws the signal's reason if it aborts, WebGpuUnavailableError.
 */
export async function soak(options: SoakOptions): Promise<SoakReport> {
  const { seed, frames, compareEvery = 20, signal, onFrame, heapBytes } = options;
  const startedMs = performance.now();
  const chance = new Chance(seed);
  const run = await Soak.start(options, chance);
  const steps: Record<string, number> = {};
  let earlyHeapBytes = 0;
  try {
    for (let frame = 1; frame <= frames && run.failures.length === 0; frame++) {
      signal?.throwIfAborted();
      const step = chance.weighted(STEPS);
      steps[step.name] = (steps[step.name] ?? 0) + 1;
      await run.take(frame, step, chance);
      // A failure may have left neither device nor engine.
      if (run.failures.length > 0) break;
      if (frame % compareEvery === 0) await run.compare();
      if (frame === Math.ceil(frames / 10)) earlyHeapBytes = heapBytes?.() ?? 0;
      onFrame?.(frame);
    }
    if (run.failures.length === 0) await run.finish();
    const heap = heapBytes ? { early: earlyHeapBytes, end: heapBytes() } : null;
    if (heap && run.failures.length === 0) run.checkHeap(heap);
    return {
      adapter: run.adapterLabel,
      seed,
      frames,
      elapsedMs: performance.now() - startedMs,
      steps,
      pictures: run.pictures,
      gpuBytes: run.gpuBytes,
      heapBytes: heap,
      failures: run.failures,
    };
  } finally {
    run.end();
  }
}

interface Seen {
  readonly picture: Float32Array;
  /** Results of picks, as JSON. */
  readonly picks: string;
}

/** Positions of picks on a diagonal of the picture, in parts of its size. */
const PICKED_PARTS = [0.25, 0.5, 0.7];

class Soak {
  readonly failures: string[] = [];
  readonly adapterLabel: string;
  pictures = 0;
  shown: SoakView;
  readonly #options: SoakOptions;
  #watched: WatchedDevice;
  #engine: SplatEngine;
  #view: SplatView;
  /** Another view of the same clouds: steps change and compare it once it takes the first one's place. */
  #beside: { view: SplatView; shown: SoakView };
  #clouds: SoakCloud[] = [];
  #frame = 0;
  #stepName = 'start';
  #mostBytes = 0;
  /** Bytes that the first engine held before it had a view. */
  readonly #bytesAtStart: number;
  #bytesAtRest: number;

  private constructor(
    options: SoakOptions,
    watched: WatchedDevice,
    engine: SplatEngine,
    [shown, beside]: readonly SoakView[],
  ) {
    this.#options = options;
    this.#watched = watched;
    this.#engine = engine;
    this.#bytesAtStart = engine.memory().totalBytes;
    this.#bytesAtRest = this.#bytesAtStart;
    this.#view = engine.createView();
    this.shown = shown;
    this.#beside = { view: engine.createView(), shown: beside };
    this.adapterLabel = adapterLabel(watched.device.adapterInfo);
  }

  static async start(options: SoakOptions, chance: Chance): Promise<Soak> {
    const watched = await WatchedDevice.request(options.gpu);
    const shown = [0, 1].map(
      (): SoakView => ({
        camera: randomCamera(chance),
        size: randomSize(chance),
        accuracy: randomAccuracy(chance),
        detail: 'full',
        sortBy: 'auto',
        background: [0, 0, 0],
      }),
    );
    return new Soak(options, watched, await engineOn(watched), shown);
  }

  get gpuBytes(): SoakReport['gpuBytes'] {
    return { most: this.#mostBytes, atRest: this.#bytesAtRest };
  }

  /** Takes a step and draws a frame. */
  async take(frame: number, step: Step, chance: Chance): Promise<void> {
    this.#frame = frame;
    this.#stepName = step.name;
    try {
      await step.run(this, chance);
      const { view, shown } = this.#beside;
      if (this.shown.detail !== 'full' || shown.detail !== 'full') await this.#makeLevels();
      this.#view.render(requestOf(this.shown, this.#clouds));
      if (chance.happens(0.3)) view.render(requestOf(shown, this.#clouds));
      // As in a page, frames mostly follow one another before shaders of the last are compiled.
      if (chance.happens(0.3)) await this.#view.whenDrawn();
      await this.#watched.device.queue.onSubmittedWorkDone();
    } catch (error) {
      this.#fail(describe(error));
    }
    this.#mostBytes = Math.max(this.#mostBytes, this.#engine.memory().totalBytes);
    await this.#takeErrors();
  }

  /** Compares picture and picks with a fresh engine's. */
  async compare(): Promise<void> {
    const { accuracy } = this.shown;
    // `auto` chooses the rasteriser by measured times, which differ between engines.
    const isAuto = typeof accuracy === 'object' && accuracy.rasterizer === 'auto';
    if (isAuto) this.shown.accuracy = { ...accuracy, rasterizer: 'tiles' };
    try {
      const seen = await this.#see(this.#view, this.#clouds);
      const fresh = await this.#seeAfresh();
      this.#options.doctor?.(fresh.picture);
      const at = firstDifference(seen.picture, fresh.picture);
      if (at >= 0) {
        const pixel = describePixel(this.shown.size.widthPx, at);
        this.#fail(`${pixel}: got ${seen.picture[at]}, a fresh engine ${fresh.picture[at]}`);
      } else if (seen.picks !== fresh.picks)
        this.#fail(`picks are ${seen.picks}, of a fresh engine ${fresh.picks}`);
      this.pictures++;
    } catch (error) {
      this.#fail(`while comparing: ${describe(error)}`);
    }
    await this.#takeErrors();
  }

  /** Frees everything after the last frame, and checks that nothing is left. */
  async finish(): Promise<void> {
    this.#stepName = 'end';
    try {
      await this.#free();
    } catch (error) {
      this.#fail(describe(error));
    }
    await this.#takeErrors();
  }

  checkHeap({ early, end }: NonNullable<SoakReport['heapBytes']>): void {
    if (end - early > HEAP_GROWTH_BYTES)
      this.#fail(`JavaScript objects take ${end} bytes, ${early} after a tenth of the frames`);
  }

  end(): void {
    this.#watched.destroy();
  }

  orbit(angle: number): void {
    const { camera } = this.shown;
    const [x, y, z] = camera.position;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    this.shown.camera = { ...camera, position: [cos * x + sin * z, y, cos * z - sin * x] };
  }

  /** Turns the camera to another target. */
  turnTo(target: [number, number, number]): void {
    this.shown.camera = { ...this.shown.camera, target };
  }

  place(chance: Chance, change: () => Partial<SoakCloud['placing']>): void {
    if (this.#clouds.length === 0) return;
    const cloud = chance.of(this.#clouds);
    cloud.placing = { ...cloud.placing, ...change() };
  }

  async add(chance: Chance): Promise<void> {
    if (this.#clouds.length === MOST_CLOUDS) this.remove(chance);
    const recipe = randomRecipe(chance);
    const placing = randomPlacing(chance);
    this.#clouds.push({ recipe, placing, ...(await makeCloud(this.#engine, recipe)) });
  }

  remove(chance: Chance): void {
    if (this.#clouds.length === 0) return;
    const [{ cloud }] = this.#clouds.splice(chance.whole(0, this.#clouds.length - 1), 1);
    cloud.destroy();
  }

  /** Begins a load and cancels it at a random moment. */
  async abortLoad(chance: Chance): Promise<void> {
    const recipe: CloudRecipe = { ...randomRecipe(chance), source: 'file' };
    const controller = new AbortController();
    const loading = makeCloud(this.#engine, recipe, controller.signal);
    const turns = chance.whole(0, 8);
    // It may fail before it is awaited below.
    loading.catch(() => {});
    for (let turn = 0; turn < turns; turn++) await nextTask();
    controller.abort();
    const made = await loading.catch((error) => {
      if (error !== controller.signal.reason) throw error;
      return null;
    });
    made?.cloud.destroy();
  }

  /** Changes a random cloud without a morph. */
  async change(chance: Chance, changeOf: (recipe: CloudRecipe) => CloudChange): Promise<void> {
    const items = this.#clouds.filter(({ recipe }) => !isMorph(recipe));
    if (items.length === 0) return;
    const item = chance.of(items);
    await this.#change(item, changeOf(item.recipe));
  }

  async pick(chance: Chance): Promise<void> {
    const { widthPx, heightPx } = this.shown.size;
    const [x, y] = [chance.within(0, 1), chance.within(0, 1)];
    this.#view.render(requestOf(this.shown, this.#clouds));
    await this.#view.pick(Math.floor(x * widthPx), Math.floor(y * heightPx));
  }

  /** Sets random amounts of all morphs. Clouds of a morph share it, also in the fresh engine. */
  morph(chance: Chance): void {
    for (const { recipe } of this.#clouds)
      if (isMorph(recipe)) recipe.source.amount = chance.of([0, 1, chance.within(0, 1)]);
  }

  swapViews(): void {
    const { view, shown } = this.#beside;
    this.#beside = { view: this.#view, shown: this.shown };
    this.#view = view;
    this.shown = shown;
  }

  renewView(): void {
    this.#view.destroy();
    this.#view = this.#engine.createView();
  }

  #createViews(): void {
    this.#view = this.#engine.createView();
    this.#beside.view = this.#engine.createView();
  }

  async clear(): Promise<void> {
    await this.#free();
    this.#createViews();
  }

  /** Frees everything, and checks that the engine is back where it started. */
  async #free(): Promise<void> {
    this.#view.destroy();
    this.#beside.view.destroy();
    for (const { cloud } of this.#clouds.splice(0)) cloud.destroy();
    await this.#watched.device.queue.onSubmittedWorkDone();
    this.#bytesAtRest = this.#engine.memory().totalBytes;
    if (this.#bytesAtRest !== this.#bytesAtStart)
      this.#fail(
        `${this.#bytesAtRest} bytes are left without clouds and views, ${this.#bytesAtStart} at the start`,
      );
  }

  /** Loses the device during work, and makes everything anew on another device. */
  async loseDevice(chance: Chance): Promise<void> {
    const recipe = randomRecipe(chance);
    const work: Promise<unknown>[] = [makeCloud(this.#engine, recipe)];
    this.#view.render(requestOf(this.shown, this.#clouds));
    work.push(this.#view.whenDrawn(), this.#view.readPixels());
    const precision = randomPrecision(chance);
    if (this.#clouds.length > 0)
      work.push(this.#engine.requestPrecision(chance.of(this.#clouds).cloud, precision));
    // The outcomes are checked below.
    const settled = Promise.allSettled(work);
    const turns = chance.whole(0, 12);
    for (let turn = 0; turn < turns; turn++) await nextTask();
    this.#watched.destroy();
    await this.#engine.lost;
    for (const outcome of await settled) {
      if (outcome.status === 'rejected' && !(outcome.reason instanceof WebSplatterError))
        this.#fail(`work under way ended with ${describe(outcome.reason)}`);
    }
    this.#engine.destroy();
    // Memory is freed when the caller's task is done, whose commands may still use it.
    await nextTask();
    const { totalBytes } = this.#engine.memory();
    if (totalBytes !== 0) this.#fail(`${totalBytes} bytes are counted after the engine was destroyed`);
    await this.#takeErrors();
    this.#watched = await WatchedDevice.request(this.#options.gpu);
    this.#engine = await engineOn(this.#watched);
    this.#createViews();
    for (const item of this.#clouds) Object.assign(item, await makeCloud(this.#engine, item.recipe));
  }

  /** Makes levels at a fixed step, not when a view needs them: they depend on the present planes. */
  async #makeLevels(): Promise<void> {
    for (const item of this.#clouds)
      if (!isMorph(item.recipe) && !item.recipe.changes.includes('levels'))
        await this.#change(item, 'levels');
  }

  async #change(item: SoakCloud, change: CloudChange): Promise<void> {
    await changeCloud(this.#engine, item, change);
    item.recipe = { ...item.recipe, changes: [...item.recipe.changes, change] };
  }

  async #see(view: SplatView, clouds: readonly Pick<SoakCloud, 'cloud' | 'placing'>[]): Promise<Seen> {
    const { widthPx, heightPx } = this.shown.size;
    view.render(requestOf(this.shown, clouds));
    const { data: picture } = await view.readPixels();
    const picks: unknown[] = [];
    for (const part of PICKED_PARTS) {
      const pick = await view.pick(Math.floor(part * widthPx), Math.floor((1 - part) * heightPx));
      picks.push({ ...pick, cloud: undefined });
    }
    return { picture, picks: JSON.stringify(picks) };
  }

  async #seeAfresh(): Promise<Seen> {
    const engine = await engineOn(this.#watched);
    const clouds = await Promise.all(
      this.#clouds.map(async ({ recipe, placing }) => ({ placing, ...(await makeCloud(engine, recipe)) })),
    );
    const seen = await this.#see(engine.createView(), clouds);
    engine.destroy();
    return seen;
  }

  async #takeErrors(): Promise<void> {
    for (const error of await this.#watched.takeErrors()) this.#fail(error);
  }

  #fail(what: string): void {
    this.failures.push(`seed ${this.#options.seed}, frame ${this.#frame} (${this.#stepName}): ${what}`);
  }
}

function engineOn({ device }: WatchedDevice): Promise<SplatEngine> {
  return createEngine({ device }, { ingestMinRows: INGEST_MIN_ROWS });
}

function isMorph(recipe: CloudRecipe): recipe is CloudRecipe & { readonly source: SplatMorph } {
  return recipe.source instanceof SplatMorph;
}

function describe(error: unknown): string {
  return error instanceof Error ? `${error.name}: ${error.message}` : String(error);
}

function nextTask(): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, 0));
}
