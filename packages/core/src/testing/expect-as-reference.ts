import { expect } from 'vitest';
import { InspectedFrame, type InspectOptions } from '../inspect/inspected-frame.ts';
import { type DecodedRecord, readRecords } from '../inspect/read-records.ts';
import { cullSplat } from '../stages/cull/cull.reference.ts';
import { splatColor } from '../stages/project/project.reference.ts';

/**
 * Draws clouds and compares every splat with float64: whether it is drawn, and its place, size,
 * opacity and colour, each within `tolerance` of its size. A splat at the cutoff's opacity may be
 * drawn or not; callers must keep centres off hard edges.
 *
 * @returns the number of drawn splats of each cloud.
 */
export async function expectAsReference(
  device: GPUDevice,
  options: InspectOptions,
  tolerance: number,
): Promise<readonly number[]> {
  // Only records are read: sorting by few bits is one pass, and needs no shaders of wide keys.
  const frame = await InspectedFrame.draw(device, { keyBits: 8, ...options });
  try {
    return await compare(frame, tolerance);
  } finally {
    frame.destroy();
  }
}

async function compare(frame: InspectedFrame, tolerance: number): Promise<number[]> {
  const { alphaCutoff } = frame.accuracy;
  const read = await readRecords(frame);
  const records = new Map<string, DecodedRecord>();
  for (const record of read) {
    const { cloud, index } = frame.locate(record.splat);
    records.set(`${frame.clouds.indexOf(cloud)} ${index}`, record);
  }
  expect(records.size, 'records of different splats').toBe(read.length);
  return frame.clouds.map(({ stored, view, effects, dilationPx2, shDegree }, cloudIndex) => {
    let count = 0;
    for (let index = 0; index < stored.count; index++) {
      const name = `splat ${index} of cloud ${cloudIndex}`;
      const record = records.get(`${cloudIndex} ${index}`);
      const settings = { alphaCutoff, dilationPx2, effects };
      const reference = cullSplat(stored, index, view, frame.projection, settings);
      if (!record || !reference) {
        const opacity = reference?.opacity ?? record?.color[3] ?? 0;
        if (opacity > alphaCutoff * (1 + tolerance))
          expect.fail(`${name}: drawn only by the GPU or only by the reference`);
        continue;
      }
      count++;
      const { a, c } = reference.covariance;
      const [x, y] = record.majorPx;
      const spread = (x * x + y * y + record.minorLengthPx ** 2) / 2;
      const pairs: (readonly [string, number, number, number])[] = [
        ['opacity', record.color[3], reference.opacity, 1],
        ['a + c', spread, a + c, a + c],
        ['x', record.centerPx[0], reference.centerPx[0], 64],
        ['y', record.centerPx[1], reference.centerPx[1], 64],
        ...splatColor(stored, index, view, shDegree, reference, effects).map(
          (value, channel) => [`colour ${channel}`, record.color[channel], value, 1] as const,
        ),
      ];
      for (const [what, got, expected, size] of pairs)
        if (!(Math.abs(got - expected) <= tolerance * size))
          expect.fail(`${name}: ${what} is ${got}, in float64 ${expected}`);
    }
    return count;
  });
}
