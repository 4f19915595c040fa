import { Gate } from './gate.ts';
import { Timestamps } from './timestamps.ts';
import type { PassWatch } from './watch-passes.ts';

/** Frames behind one gate, besides the first. */
const BURST = 8;
const MOST_PASSES = 200;
/** How much longer the gate is than everything behind it took without a gate. */
const GATE_SLACK = 1.5;

/** Name of what lies between a frame's passes and copies. */
const BETWEEN = 'between these: barriers, queue writes, these timestamps';

/** A pass or copy of a frame. */
export interface PassTime {
  readonly name: string;
  readonly ms: number;
}

/** Frames of a turn, measured twice: undisturbed, and pass by pass. */
export interface MeasuredFrames {
  /** Of each frame, from the end of the one before to its own end. */
  readonly frameMs: readonly number[];
  /**
   * Passes and copies of each frame in order, each from the end of all before it to its own end. The
   * last one of a frame is all that lies between them.
   */
  readonly passes: readonly (readonly PassTime[])[];
}

/** Draws a frame of a turn, by number, without waiting for the GPU. */
type DrawFrame = (frame: number) => void | Promise<void>;

/**
 * GPU times of whole frames, and of their passes, by any code on the page. Frames are submitted
 * behind a gate: the GPU meets them without a gap, so the time between two timestamps contains all
 * of a frame, queue writes and barriers included, and nothing of the CPU.
 */
export class FrameTimes {
  readonly #device: GPUDevice;
  readonly #gate: Gate;
  readonly #watch: PassWatch;
  readonly #timestamps: Timestamps;
  #gateMs = 0;

  private constructor(device: GPUDevice, gate: Gate, watch: PassWatch) {
    this.#device = device;
    this.#gate = gate;
    this.#watch = watch;
    this.#timestamps = new Timestamps(device, 2 * (MOST_PASSES + 1));
  }

  /** @param device has timestamps. */
  static async of(device: GPUDevice, watch: PassWatch): Promise<FrameTimes> {
    return new FrameTimes(device, await Gate.of(device), watch);
  }

  async measure(frames: number, draw: DrawFrame): Promise<MeasuredFrames> {
    const frameMs = await this.#framesMs(frames, draw);
    const passes: PassTime[][] = [];
    for (let frame = 0; frame < frames; frame++) passes.push(await this.#passesOf(frame, draw));
    return { frameMs, passes };
  }

  async #framesMs(frames: number, draw: DrawFrame): Promise<number[]> {
    const queue = this.#device.queue;
    const burst = async (first: number) => {
      for (let i = 0; i <= BURST; i++) {
        await draw(first + i);
        queue.submit([this.#timestamps.commands(i)]);
      }
    };
    await this.#fitGate(() => burst(0));
    const found: number[] = [];
    while (found.length < frames) {
      this.#gate.close(this.#gateMs);
      await burst(found.length);
      const ends = await this.#timestamps.read(BURST + 1);
      // The first frame may have overlapped the gate.
      for (let i = 1; i <= BURST; i++) found.push(Number(ends[i] - ends[i - 1]) / 1e6);
    }
    return found.slice(0, frames);
  }

  async #passesOf(frame: number, draw: DrawFrame): Promise<PassTime[]> {
    const names: string[] = [];
    const timestamps = this.#timestamps;
    // Recording a timestamp is a pass itself.
    const unwatched = (encoder: GPUCommandEncoder, index: number) => {
      const { listener } = this.#watch;
      this.#watch.listener = null;
      timestamps.record(encoder, Math.min(index, 2 * MOST_PASSES));
      this.#watch.listener = listener;
    };
    this.#gate.close(this.#gateMs);
    // Not measured: it may overlap the gate.
    await draw(frame);
    this.#device.queue.submit([timestamps.commands(0)]);
    this.#watch.listener = {
      before: (encoder, name) => {
        const pass = names.push(name) - 1;
        unwatched(encoder, 2 * pass + 1);
        return pass;
      },
      after: (encoder, pass) => unwatched(encoder, 2 * pass + 2),
    };
    try {
      await draw(frame + 1);
    } finally {
      this.#watch.listener = null;
    }
    if (names.length >= MOST_PASSES) throw new Error(`A frame has more than ${MOST_PASSES} passes.`);
    const last = 2 * names.length + 1;
    this.#device.queue.submit([timestamps.commands(last)]);
    const times = await timestamps.read(last + 1);
    const ms = (from: number, to: number) => Number(times[to] - times[from]) / 1e6;
    const passes = names.map((name, i) => ({ name, ms: ms(2 * i + 1, 2 * i + 2) }));
    const inPasses = passes.reduce((sum, pass) => sum + pass.ms, 0);
    return [...passes, { name: BETWEEN, ms: ms(0, last) - inPasses }];
  }

  /** Makes the gate longer than `work` takes from its first call to its end on the GPU. */
  async #fitGate(work: () => Promise<void>): Promise<void> {
    const startedMs = performance.now();
    await work();
    await this.#device.queue.onSubmittedWorkDone();
    this.#gateMs = GATE_SLACK * (performance.now() - startedMs);
  }
}
