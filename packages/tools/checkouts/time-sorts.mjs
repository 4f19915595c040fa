// Times the sort of one checkout on the GPU, as bench-sort.mjs asks over IPC: `node time-sorts.mjs OPTIONS`, which are JSON.
import { openCheckout } from './open-checkout.mjs';

const { folder, dawn } = JSON.parse(process.argv[2]);
const { inspect, device, adapterLabel, takeErrors } = await openCheckout({ folder, dawn });
const { Pipelines, orderFlaw, sortKeys } = inspect;
const pipelines = new Pipelines(device);
/** What the next compute pass is recorded for: `sortKeys` gives no access to its buffers and passes. */
let timing = null;

if (device.features.has('timestamp-query')) {
  watchKeys();
  repeatPasses();
  process.on('message', (request) => {
    timeSorts(request).then(
      (timesMs) => process.send({ timesMs }),
      (error) => process.send({ error: error.message }),
    );
  });
  process.send({ adapter: adapterLabel });
} else {
  process.send({ error: `${adapterLabel} has no GPU timestamps.` });
}

/** GPU times of the same sort, ms. */
async function timeSorts({ keyCount, keyBits, repeats, seed, isChecked }) {
  const keys = randomKeys(keyCount, keyBits, seed);
  timing = { repeats, keys, keysBuffer: null, savedKeys: null, timestamps: null };
  try {
    const order = await sortKeys(device, pipelines, keys, keyBits);
    const flaw = isChecked ? orderFlaw(keys, order) : null;
    if (flaw) throw new Error(`the order of ${keyCount} keys of ${keyBits} bits is wrong: ${flaw}`);
    const times = await readTimes(timing.timestamps);
    const errors = await takeErrors();
    if (errors.length > 0) throw new Error(errors.join('; '));
    return times;
  } finally {
    timing.savedKeys?.destroy();
    timing.timestamps?.destroy();
    timing = null;
  }
}

/** Keeps a copy of the keys and notes which buffer has them: sorting overwrites it, and each repetition is to find them. */
function watchKeys() {
  const { queue } = device;
  const writeBuffer = queue.writeBuffer.bind(queue);
  queue.writeBuffer = (buffer, offset, data, ...rest) => {
    writeBuffer(buffer, offset, data, ...rest);
    if (!timing || data.byteLength !== timing.keys.byteLength) return;
    timing.keysBuffer = buffer;
    timing.savedKeys = device.createBuffer({
      size: data.byteLength,
      usage: GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST,
    });
    writeBuffer(timing.savedKeys, 0, data);
  };
}

/** Makes encoders repeat a compute pass, each time with the keys as they were, and with timestamps. */
function repeatPasses() {
  const createCommandEncoder = device.createCommandEncoder.bind(device);
  device.createCommandEncoder = (descriptor) => {
    const encoder = createCommandEncoder(descriptor);
    const beginComputePass = encoder.beginComputePass.bind(encoder);
    encoder.beginComputePass = () => {
      const commands = [];
      const note =
        (name) =>
        (...values) =>
          commands.push([name, values]);
      const pass = { end: () => recordRepeats(encoder, beginComputePass, commands) };
      for (const name of ['setPipeline', 'setBindGroup', 'dispatchWorkgroups', 'dispatchWorkgroupsIndirect'])
        pass[name] = note(name);
      return pass;
    };
    return encoder;
  };
}

function recordRepeats(encoder, beginComputePass, commands) {
  const { repeats, keysBuffer, savedKeys } = timing;
  const querySet = device.createQuerySet({ type: 'timestamp', count: 2 * repeats });
  for (let i = 0; i < repeats; i++) {
    encoder.copyBufferToBuffer(savedKeys, 0, keysBuffer, 0, savedKeys.size);
    const timestampWrites = {
      querySet,
      beginningOfPassWriteIndex: 2 * i,
      endOfPassWriteIndex: 2 * i + 1,
    };
    const pass = beginComputePass({ timestampWrites });
    for (const [name, values] of commands) pass[name](...values);
    pass.end();
  }
  timing.timestamps = device.createBuffer({
    size: 16 * repeats,
    usage: GPUBufferUsage.QUERY_RESOLVE | GPUBufferUsage.COPY_SRC,
  });
  encoder.resolveQuerySet(querySet, 0, 2 * repeats, timing.timestamps, 0);
}

async function readTimes(timestamps) {
  const { size } = timestamps;
  const readback = device.createBuffer({ size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(timestamps, 0, readback, 0, size);
  device.queue.submit([encoder.finish()]);
  await readback.mapAsync(GPUMapMode.READ);
  const ns = new BigUint64Array(readback.getMappedRange().slice(0));
  readback.destroy();
  return Array.from({ length: ns.length / 2 }, (_, i) => Number(ns[2 * i + 1] - ns[2 * i]) / 1e6);
}

function randomKeys(count, bits, seed) {
  // A linear congruential generator; its upper bits are the random ones.
  let state = BigInt(seed);
  const keys = new Uint32Array(count);
  for (let i = 0; i < count; i++) {
    state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    keys[i] = Number(state >> BigInt(64 - bits));
  }
  return keys;
}
