import { InvalidArgumentError } from '../errors.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { ImageDifference } from '../reference/compare-images.ts';
import { compareImages } from '../stages/compare-images.ts';
import { compareTextures } from './compare-textures.ts';
import type { ComparedView } from './measured-engine.ts';

/**
 * How far the last picture of one view is from that of another of the same engine, computed on the GPU: only numbers are
 * read back, so that it takes milliseconds at any size.
 *
 * @param background what is behind both, 0…1; default black.
 * @throws InvalidArgumentError where a view has no picture yet or the sizes differ, NonFiniteImageError,
 * DestroyedError.
 */
export async function compareViews(
  actual: ComparedView,
  expected: ComparedView,
  background?: Vec3,
): Promise<ImageDifference> {
  await Promise.all([actual.whenDrawn(), expected.whenDrawn()]);
  // Before the textures are taken: while it compiled, either view could have been drawn in another size.
  await actual.blended().context.pipelines.prepare([compareImages]);
  const [a, b] = [actual.blended(), expected.blended()];
  if (!a.color || !b.color) {
    const missing = a.color ? 'expected' : 'actual';
    throw new InvalidArgumentError(missing, `The view ${missing} has no picture yet: call render first.`);
  }
  return compareTextures(a.context, a.color, b.color, background);
}
