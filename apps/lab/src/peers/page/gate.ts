import { Timestamps } from './timestamps.ts';

const FIRST_ROUNDS = 100_000;
const MEASUREMENTS = 3;
/** Drivers reset a GPU that is busy for some seconds. */
const LONGEST_MS = 500;

const SHADER = `
@group(0) @binding(0) var<storage, read_write> value: u32;
@group(0) @binding(1) var<storage, read> rounds: u32;
@compute @workgroup_size(1) fn spin() {
  var x = value;
  for (var i = 0u; i < rounds; i++) { x = x * 1664525u + 1013904223u; }
  value = x;
}`;

/**
 * Keeps a GPU busy while frames are submitted behind it, so that the GPU never waits for the CPU
 * within these frames.
 */
export class Gate {
  readonly #device: GPUDevice;
  readonly #pipeline: GPUComputePipeline;
  readonly #rounds: GPUBuffer;
  readonly #group: GPUBindGroup;
  /** At the GPU's highest clock. */
  #roundsPerMs = 0;

  private constructor(device: GPUDevice) {
    this.#device = device;
    const module = device.createShaderModule({ code: SHADER });
    this.#pipeline = device.createComputePipeline({ layout: 'auto', compute: { module } });
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
    const value = device.createBuffer({ size: 4, usage });
    this.#rounds = device.createBuffer({ size: 4, usage });
    this.#group = device.createBindGroup({
      layout: this.#pipeline.getBindGroupLayout(0),
      entries: [value, this.#rounds].map((buffer, binding) => ({ binding, resource: { buffer } })),
    });
  }

  static async of(device: GPUDevice): Promise<Gate> {
    const gate = new Gate(device);
    const timestamps = new Timestamps(device, 2);
    for (let i = 0; i < MEASUREMENTS; i++) {
      device.queue.submit([timestamps.commands(0)]);
      gate.#submit(FIRST_ROUNDS);
      device.queue.submit([timestamps.commands(1)]);
      const [from, to] = await timestamps.read(2);
      gate.#roundsPerMs = Math.max(gate.#roundsPerMs, FIRST_ROUNDS / (Number(to - from) / 1e6));
    }
    return gate;
  }

  /** Submits work that takes the GPU so long. */
  close(ms: number): void {
    this.#submit(Math.min(ms, LONGEST_MS) * this.#roundsPerMs);
  }

  #submit(rounds: number): void {
    this.#device.queue.writeBuffer(this.#rounds, 0, Uint32Array.of(rounds));
    const encoder = this.#device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(this.#pipeline);
    pass.setBindGroup(0, this.#group);
    pass.dispatchWorkgroups(1);
    pass.end();
    this.#device.queue.submit([encoder.finish()]);
  }
}
