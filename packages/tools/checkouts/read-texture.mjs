const CHANNELS = { rgba8unorm: 4, rgba16float: 4, r32float: 1 };
const BYTES_PER_CHANNEL = { rgba8unorm: 1, rgba16float: 2, r32float: 4 };

/** A texture's contents as float32, exactly. */
export async function readTexture(device, texture) {
  const { width, height, format } = texture;
  const rowValues = width * CHANNELS[format];
  const bytesPerRow = Math.ceil((rowValues * BYTES_PER_CHANNEL[format]) / 256) * 256;
  const buffer = device.createBuffer({
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  const encoder = device.createCommandEncoder();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [width, height]);
  device.queue.submit([encoder.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const contents = buffer.getMappedRange().slice(0);
  buffer.destroy();
  const values = new Float32Array(rowValues * height);
  for (let row = 0; row < height; row++)
    values.set(decodeRow(format, contents, row * bytesPerRow, rowValues), row * rowValues);
  return { widthPx: width, heightPx: height, values };
}

function decodeRow(format, contents, byteOffset, count) {
  if (format === 'r32float') return new Float32Array(contents, byteOffset, count);
  if (format === 'rgba16float')
    return Float32Array.from(new Uint16Array(contents, byteOffset, count), fromHalf);
  return Float32Array.from(new Uint8Array(contents, byteOffset, count), (value) => value / 255);
}

function fromHalf(bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 31) return fraction ? Number.NaN : sign * Number.POSITIVE_INFINITY;
  return exponent === 0 ? sign * fraction * 2 ** -24 : sign * (1024 + fraction) * 2 ** (exponent - 25);
}
