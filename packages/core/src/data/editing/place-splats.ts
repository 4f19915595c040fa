import { InvalidArgumentError } from '../errors.ts';
import { centerBounds } from '../packing/center-bounds.ts';
import { chooseOrigin } from '../packing/origin.ts';
import { PositionSample } from '../packing/position-sample.ts';
import type { SplatColumns } from '../splats/splat-set.ts';

/**
 * Positions in the scene's space, 3N, as the columns that hold them: relative to the origin that
 * suits them.
 *
 * @throws InvalidArgumentError 'set' if one of them is too large for float32.
 */
export function placeSplats(positions: Float64Array): Pick<SplatColumns, 'origin' | 'positions'> {
  const count = positions.length / 3;
  const sample = new PositionSample();
  sample.addAll(positions, count);
  const origin = chooseOrigin(sample.axes, centerBounds(positions, count), true);
  const relative = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i++) {
    relative[i] = positions[i] - origin[i % 3];
    if (Number.isFinite(relative[i])) continue;
    const message = `Splat ${Math.floor(i / 3)} would be at ${positions[i]}, which float32 cannot hold.`;
    throw new InvalidArgumentError('set', message);
  }
  return { origin, positions: relative };
}
